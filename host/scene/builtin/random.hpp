// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec3.hpp>
#include <random>

namespace manylight {

/// The same numbers on every platform: the standard fixes the engine, not its distributions.
class Random {
  public:
    explicit Random(unsigned seed) : engine_(seed) {}
    [[nodiscard]] float in(float lower, float upper) {
        return lower + (upper - lower) * static_cast<float>(engine_() >> 8) * 0x1p-24f;
    }
    [[nodiscard]] unsigned below(unsigned n) { return engine_() % n; }
    [[nodiscard]] glm::vec3 in(glm::vec3 lower, glm::vec3 upper) {
        const float x = in(lower.x, upper.x);
        const float y = in(lower.y, upper.y);
        return {x, y, in(lower.z, upper.z)};
    }

  private:
    std::mt19937 engine_;
};

/// A colour of that hue (in turns) with its largest channel 1; saturation 0 is white.
[[nodiscard]] glm::vec3 hue_color(float turns, float saturation);

}  // namespace manylight
