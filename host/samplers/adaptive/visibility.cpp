// SPDX-License-Identifier: MIT
#include "samplers/adaptive/visibility.hpp"

namespace manylight {

Visibility::Visibility(Device& device, std::size_t lights, std::size_t tiles, std::size_t in_work)
    : counts(device.allocate<uint>(tiles * slots(lights) * CELLS_PER_TILE)),
      totals(device.allocate<Trials>(tiles * CUT_CAPACITY)),
      shared(device.allocate<Trials>(tiles * CUT_CAPACITY)),
      visible(device.allocate<float>(in_work * slots(lights) * CELLS_PER_TILE)) {}

Arguments Visibility::arguments() const {
    return Arguments()
        .set("counts", counts)
        .set("totals", totals)
        .set("shared", shared)
        .set("visible", visible);
}

VisibilityStage::VisibilityStage(Device& device, const DeviceScene& scene)
    : scene_(scene.arguments), lanes_(device.form().pixels) {
    Defines defines = scene.traversal;
    defines["LANES"] = static_cast<int>(lanes_);
    const auto kernel = [&](const char* name) {
        return device.kernel("samplers/adaptive/visibility.cl", name, defines, "visibility");
    };
    learn_ = kernel("visibility_learn");
    sum_ = kernel("visibility_sum");
    share_ = kernel("visibility_share");
    estimate_ = kernel("visibility_estimate");
}

void VisibilityStage::learn(const Pass& pass, const Arguments& draws, Visibility& out) {
    learn_.launch(std::size_t{pass.tile_count} * 4,
                  Arguments(scene_).set(draws).set(out.arguments()).set("pass", pass));
}

void VisibilityStage::sum(const Tiles& tiles, const Cuts& cuts, Visibility& out) {
    const Arguments arguments =
        Arguments(scene_).set(cuts.arguments()).set(out.arguments()).set("tiles", tiles);
    sum_.launch(std::size_t{tiles.count} * CUT_CAPACITY, arguments);
    share_.launch(std::size_t{tiles.count} * CUT_CAPACITY, arguments);
}

void VisibilityStage::estimate(uint first, uint count, const Cuts& cuts, Visibility& out) {
    estimate_.launch(std::size_t{count} * CELLS_PER_TILE / lanes_, Arguments(scene_)
                                                                       .set(cuts.arguments())
                                                                       .set(out.arguments())
                                                                       .set("first_tile", first)
                                                                       .set("tile_count", count));
}

}  // namespace manylight
