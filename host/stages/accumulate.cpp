// SPDX-License-Identifier: MIT
#include "stages/accumulate.hpp"

#include "stages/samples.hpp"

namespace manylight {
namespace {

template <class T>
Buffer<T> zeros(Device& device, std::size_t count) {
    Buffer<T> buffer = device.allocate<T>(count);
    buffer.clear();
    return buffer;
}

}  // namespace

ImageSum::ImageSum(Device& device, std::size_t pixels, bool grouped)
    : sums(zeros<float4>(device, pixels)),
      residuals(zeros<float4>(device, pixels)),
      weights(zeros<float>(device, pixels)) {
    if (grouped) groups = zeros<float4>(device, ERROR_GROUPS * pixels);
}

AccumulateStage::AccumulateStage(Device& device, const DeviceScene& scene, bool grouped)
    : scene_(scene.arguments), grouped_(grouped) {
    auto defines = scene.emission;
    defines["HAS_GROUPS"] = grouped;
    add_ = device.kernel("accumulate.cl", "accumulate_add", defines, "accumulate");
    add_pass_ = device.kernel("accumulate.cl", "accumulate_add_pass", defines, "accumulate");
}

void AccumulateStage::add(const Tiles& tiles, const std::optional<Pass>& pass,
                          const Buffer<Surface>& surfaces, const Buffer<float4>& estimates,
                          const Buffer<float4>& seen, SampleWeight weight, ImageSum& image) {
    Arguments arguments = scene_;
    arguments.set("tiles", tiles)
        .set("surfaces", surfaces)
        .set("estimates", estimates)
        .set("seen", seen)
        .set("weight", weight.weight)
        .set("image", image.sums)
        .set("residuals", image.residuals)
        .set("weights", image.weights);
    if (grouped_) arguments.set("group", weight.group).set("groups", image.groups);
    if (pass)
        add_pass_.launch(pass_pixels(*pass), arguments.set("pass", *pass));
    else
        add_.launch(item_count(tiles), arguments);
}

}  // namespace manylight
