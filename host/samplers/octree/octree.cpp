// SPDX-License-Identifier: MIT
#include "samplers/octree/octree.hpp"

#include <numeric>

#include "samplers/octree/build_octree.hpp"

namespace manylight {
namespace {

// The default is what Walter et al. ("Lightcuts", 2005) take, below what the eye sees of a step.
std::vector<Parameter> parameters() {
    return {{.name = "epsilon",
             .value = 0.02,
             .least = 0,
             .most = 1,
             .summary = "a node is one light where it differs from that by less than this times "
                        "the light of all nodes"}};
}

template <bool to_virtual>
std::unique_ptr<LightSampler> make_octree(const SamplerContext& context) {
    return std::make_unique<Octree>(context, to_virtual);
}

}  // namespace

Octree::Octree(const SamplerContext& context, bool to_virtual)
    : epsilon_(static_cast<float>(context.parameter("epsilon"))),
      to_virtual_(to_virtual),
      nodes_(build_octree(context.lights)),
      scene_(context.scene.arguments),
      shadows_(context.device, context.scene, context.items()),
      draw_(context.device.kernel("samplers/octree/octree.cl", "octree_draw", context.scene.shading,
                                  "samples")),
      add_(context.device.kernel("samples.cl", "samples_add", context.scene.traversal, "samples")),
      device_nodes_(context.device.upload(nodes_)),
      next_nodes_(context.device.allocate<uint>(context.items())),
      totals_(context.device.allocate<float4>(next_nodes_.size())),
      values_(context.device.allocate<float>(48 * next_nodes_.size())) {}

// Of each pixel 16 nodes of the cut at a time.
bool Octree::draw(const Tiles& tiles, const PixelSample& sample, uint light_samples,
                  const Buffer<Surface>& surfaces, Estimates& estimates, const Sink& sink) {
    const std::size_t items = item_count(tiles);
    Arguments arguments = scene_;
    arguments.set(shadows_.buffers())
        .set("tiles", tiles)
        .set("surfaces", surfaces)
        .set("octree", device_nodes_)
        .set("octree_size", static_cast<uint>(nodes_.size()))
        .set("epsilon", epsilon_)
        .set("to_virtual", uint{to_virtual_})
        .set("next_nodes", next_nodes_)
        .set("totals", totals_)
        .set("pixel_sample", sample.index)
        .set("seed", sample.seed)
        .set("values", values_)
        .set("estimates", estimates.sums)
        .set("residuals", estimates.residuals);
    const double all = static_cast<double>(items) * light_samples;
    double told = 0;
    for (bool first = true;; first = false) {
        arguments.set("start", uint{first});
        draw_.launch(items, arguments);
        shadows_.trace(items, sample.salt());
        add_.launch(items, arguments);
        const double done = share_done(items);
        const bool goes_on = sink({}, static_cast<std::size_t>(all * done - told));
        told += static_cast<double>(static_cast<std::size_t>(all * done - told));
        if (done >= 1) return true;
        if (!goes_on) return false;
    }
}

double Octree::share_done(std::size_t items) const {
    const std::vector<uint> next = next_nodes_.download(0, items);
    const auto passed = std::accumulate(next.begin(), next.end(), std::uint64_t{0});
    const std::uint64_t all = std::uint64_t{nodes_.size()} * items;
    return passed == all ? 1 : static_cast<double>(passed) / (static_cast<double>(all) + 1);
}

Footprint Octree::footprint(const SamplerLoad& load) {
    Footprint out;
    const std::size_t items = load.tile_items();
    out.image = 2 * sizeof(OctreeNode) * load.lights;
    out.tile = items * (SampleStage::item_bytes() + sizeof(uint) + sizeof(float4));
    out.tile_buffer = items * 64 * sizeof(float);  // rays
    return out;
}

Sampler sampler_octree() {
    return {
        .name = "octree",
        .summary = "a light of each node of an octree, down to those that are as good as one light",
        .color = "#637939",
        .own_rays = true,
        .parameters = parameters(),
        .footprint = Octree::footprint,
        .make = make_octree<false>};
}

Sampler sampler_octree_virtual() {
    return {.name = "octree-virtual",
            .summary = "octree with virtual lights, where shadows leak (Paquette et al. 1998)",
            .color = "#b5cf6b",
            .biased = true,
            .own_rays = true,
            .parameters = parameters(),
            .footprint = Octree::footprint,
            .make = make_octree<true>};
}

}  // namespace manylight
