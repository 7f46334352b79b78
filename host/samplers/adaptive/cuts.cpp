// SPDX-License-Identifier: MIT
#include "samplers/adaptive/cuts.hpp"

namespace manylight {

Cuts::Cuts(Device& device, std::size_t tiles)
    : nodes(device.allocate<uint>(tiles * CUT_CAPACITY)),
      sizes(device.allocate<uint>(tiles)),
      probes(device.allocate<Trials>(tiles * CUT_CAPACITY)) {}

Arguments Cuts::arguments() const {
    return Arguments().set("cut_nodes", nodes).set("cut_sizes", sizes).set("probes", probes);
}

CutStage::CutStage(Device& device, const DeviceScene& scene)
    : scene_(scene.arguments),
      make_(device.kernel("samplers/adaptive/cuts.cl", "cuts_make", scene.shading, "cuts")) {}

void CutStage::make(const Tiles& tiles, const Buffer<Surface>& surfaces, const CutOptions& options,
                    Cuts& cuts) {
    make_.launch(tiles.count, Arguments(scene_)
                                  .set(cuts.arguments())
                                  .set("tiles", tiles)
                                  .set("surfaces", surfaces)
                                  .set("cut_size", options.size)
                                  .set("probe_rays", options.probe_rays)
                                  .set("seed", options.seed));
}

}  // namespace manylight
