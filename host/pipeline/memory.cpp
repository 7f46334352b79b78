// SPDX-License-Identifier: MIT
#include "pipeline/memory.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace manylight {

void PartMemory::check() const {
    if (use->most > planned)
        throw std::logic_error(fmt::format(
            "{}: {} bytes were allocated on the device, and {} planned", part, use->most, planned));
}

FrameMemory::FrameMemory(const Plan& plan, std::string_view sampler)
    : scene{"the scene", plan.scene_bytes + plan.point_bytes},
      image{"the image", plan.image_bytes},
      pixels{"pixels in work", plan.batch_bytes - plan.point_bytes - plan.sampler_bytes},
      sampler{fmt::format("sampler {}", sampler), plan.sampler_bytes} {}

}  // namespace manylight
