// SPDX-License-Identifier: MIT
#include "samplers/adaptive/adaptive_samples.hpp"

#include <bit>

namespace manylight {

AdaptiveStage::AdaptiveStage(Device& device, const DeviceScene& scene, std::size_t packets,
                             std::size_t pixels)
    : scene_(scene.arguments),
      lanes_(device.form().pixels),
      shadows_(device, scene, packets, true),
      draws_(device.allocate<uint>(64 * packets)),
      draw_counts_(device.allocate<uint>((packets + lanes_ - 1) / lanes_)),
      pixel_packets_(device.allocate<uint>(2 * packets)),
      packet_counts_(device.allocate<uint>((packets + lanes_ - 1) / lanes_)),
      base_(device.allocate<float>(3 * packets)),
      values_(device.allocate<float>(48 * packets)),
      expectations_(device.allocate<Expectation>(pixels)) {
    Defines defines = scene.shading;
    defines["LANES"] = static_cast<int>(lanes_);
    draw_ = device.kernel("samplers/adaptive/adaptive.cl", "adaptive_draw", defines, "weights");
    aim_ =
        device.kernel("samplers/adaptive/adaptive_samples.cl", "adaptive_aim", defines, "samples");
    add_ =
        device.kernel("samplers/adaptive/adaptive_samples.cl", "adaptive_add", defines, "samples");
}

Arguments AdaptiveStage::draws() const {
    return shadows_.buffers()
        .set("draws", draws_)
        .set("draw_counts", draw_counts_)
        .set("pixel_packets", pixel_packets_)
        .set("packet_counts", packet_counts_)
        .set("base", base_)
        .set("values", values_);
}

void AdaptiveStage::draw(const Tiles& tiles, const Pass& pass, const Budget& budget,
                         const PixelSample& sample, const Buffer<Surface>& surfaces,
                         const Cuts& cuts, const Visibility& visibility, float weight, bool start,
                         Estimates& estimates) {
    Arguments arguments = scene_;
    arguments.set(cuts.arguments())
        .set(visibility.arguments())
        .set(draws())
        .set("expectations", expectations_)
        .set("tiles", tiles)
        .set("pass", pass)
        .set("budget", budget)
        .set("surfaces", surfaces)
        .set("pixel_sample", sample.index)
        .set("seed", sample.seed)
        .set("weight", weight)
        .set("start", uint{start})
        .set("estimates", estimates.sums);
    const std::size_t groups = pass_pixels(pass) / lanes_;
    draw_.launch(groups, arguments);
    aim_.launch(groups, arguments);
    shadows_.trace(pass_pixels(pass) * pass.packets, lanes_ * pass.packets, packet_counts_,
                   sample.salt());
    add_.launch(pass_pixels(pass), arguments);
}

std::vector<std::vector<DrawnNode>> AdaptiveStage::drawn(const Pass& pass) const {
    const std::vector<uint> draws = draws_.download();
    const std::vector<uint> counts = draw_counts_.download();
    const std::vector<uint> packets = pixel_packets_.download();
    const std::vector<float> rays = shadows_.rays().download();
    std::vector<std::vector<DrawnNode>> out(pass_pixels(pass));
    for (std::size_t group = 0; group < out.size() / lanes_; ++group)
        for (std::size_t draw = 0; draw < counts[group]; ++draw) {
            const uint* row = &draws[64 * (lanes_ * pass.packets * group + draw / 16) + draw % 16];
            const std::size_t lane = row[16] % 16;
            const std::size_t number = (row[16] >> 4) % 512;
            const std::size_t packet = packets[2 * lanes_ * group + lane] + number / 16;
            out[lanes_ * group + lane].push_back({row[0] % (1 << 24), row[0] >> 24,
                                                  std::bit_cast<float>(row[32]),
                                                  rays[64 * packet + 48 + number % 16]});
        }
    return out;
}

}  // namespace manylight
