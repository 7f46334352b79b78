// SPDX-License-Identifier: MIT
#include <algorithm>

#include "samplers/ward/ward.hpp"

namespace manylight {
namespace {

// Sampler ward-unbiased: light samples of the lights that the walk leaves, with what sampler ward
// adds for them as control variate.
class WardUnbiased : public Ward {
  public:
    explicit WardUnbiased(const SamplerContext& context)
        : Ward(context), values_(context.device.allocate<float>(48 * slots())) {
        const auto kernel = [&](const char* name) {
            return context.device.kernel("samplers/ward/unbiased.cl", name, context.scene.shading,
                                         "samples");
        };
        draw_ = kernel("ward_draw_tail");
        add_ = kernel("ward_add_tail");
    }

    [[nodiscard]] static Footprint footprint(const SamplerLoad& load) {
        Footprint out = Ward::footprint(load);
        out.fixed += slots_of(load) * 48 * sizeof(float);
        return out;
    }

  protected:
    void draw_tail(std::size_t slots, const PixelSample& sample, uint light_samples,
                   Arguments& arguments) override {
        arguments.set("values", values_).set("draw_count", light_samples);
        for (uint first = 0; first < light_samples; first += 16) {
            arguments.set("first_draw", first).set("end_draw", std::min(first + 16, light_samples));
            draw_.launch(slots, arguments);
            shadows().trace(slots, sample.salt());
            add_.launch(slots, arguments);
        }
    }

  private:
    Kernel draw_;
    Kernel add_;
    Buffer<float> values_;  // [48 * slot + 16 * channel + lane]
};

}  // namespace

Sampler sampler_ward_unbiased() {
    return {.name = "ward-unbiased",
            .summary = "brightest lights first, until the rest matters little; that is sampled",
            .color = "#80b918",
            .own_rays = true,
            .most_lights = most_ward_lights,
            .parameters = ward_parameters(),
            .footprint = WardUnbiased::footprint,
            .make = [](const SamplerContext& context) -> std::unique_ptr<LightSampler> {
                return std::make_unique<WardUnbiased>(context);
            }};
}

}  // namespace manylight
