// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <glm/vec2.hpp>

#include "shared/types.h"

namespace manylight::reference {

/// Four uniform integers for a pixel, pixel sample, dimension and seed: pcg4d (Jarzynski and Olano,
/// "Hash Functions for GPU Rendering", JCGT 9:3, 2020).
[[nodiscard]] std::array<uint, 4> random_bits(uint pixel, uint pixel_sample, uint dimension,
                                              uint seed);

/// 32 bits for step i of what starts with 32 random bits: pcg_hash of the same paper.
[[nodiscard]] uint step_bits(uint bits, uint i);

/// In [0, 1): the top 24 bits as a fraction.
[[nodiscard]] double unit_fraction(uint bits);

/// Nested uniform scrambling by Laine and Karras' hash as given by Burley ("Practical Hash-based
/// Owen Scrambling", JCGT 9:4, 2020).
[[nodiscard]] uint owen_scrambled(uint value, uint seed);

/// Point `index`, in [0, 1)^2, of Sobol's first two dimensions, each Owen-scrambled.
[[nodiscard]] glm::dvec2 sobol_point(uint index, uint x_seed, uint y_seed);

/// Where in its pixel, [0, 1)^2, a pixel sample lies: the Sobol point of its own number.
[[nodiscard]] glm::dvec2 pixel_position(uint pixel, uint pixel_sample, uint seed);

}  // namespace manylight::reference
