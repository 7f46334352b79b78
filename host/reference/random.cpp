// SPDX-License-Identifier: MIT
#include "reference/random.hpp"

namespace manylight::reference {
namespace {

uint mirrored(uint value) {
    uint out = 0;
    for (int bit = 0; bit < 32; ++bit) out |= (value >> bit & 1) << (31 - bit);
    return out;
}

uint laine_karras(uint value, uint seed) {
    value += seed;
    for (const uint factor : {0x6c50b47cu, 0xb82f1e52u, 0xc7afe638u, 0x8d22f6e6u})
        value ^= value * factor;
    return value;
}

// Pascal's triangle modulo 2 gives the generator matrix of Sobol's second dimension.
uint sobol_second(uint index) {
    uint out = 0;
    uint column = 1u << 31;
    for (int bit = 0; bit < 32; ++bit, column ^= column >> 1)
        if (index >> bit & 1) out ^= column;
    return out;
}

}  // namespace

std::array<uint, 4> random_bits(uint pixel, uint pixel_sample, uint dimension, uint seed) {
    std::array<uint, 4> v = {pixel, pixel_sample, dimension, seed};
    for (uint& word : v) word = word * 1664525u + 1013904223u;
    const auto round = [&v] {
        v[0] += v[1] * v[3];
        v[1] += v[2] * v[0];
        v[2] += v[0] * v[1];
        v[3] += v[1] * v[2];
    };
    round();
    for (uint& word : v) word ^= word >> 16;
    round();
    return v;
}

uint step_bits(uint bits, uint i) {
    const uint state = (bits + i * 0x9e3779b9u) * 747796405u + 2891336453u;
    const uint word = ((state >> ((state >> 28) + 4)) ^ state) * 277803737u;
    return (word >> 22) ^ word;
}

double unit_fraction(uint bits) { return (bits >> 8) / 16777216.0; }

// Scrambling works on mirrored digits.
uint owen_scrambled(uint value, uint seed) { return mirrored(laine_karras(mirrored(value), seed)); }

// The first dimension is the mirrored index.
glm::dvec2 sobol_point(uint index, uint x_seed, uint y_seed) {
    return {unit_fraction(owen_scrambled(mirrored(index), x_seed)),
            unit_fraction(owen_scrambled(sobol_second(index), y_seed))};
}

glm::dvec2 pixel_position(uint pixel, uint pixel_sample, uint seed) {
    const auto scramble = random_bits(pixel, 0, 0xffffffffu, seed);
    return sobol_point(pixel_sample, scramble[0], scramble[1]);
}

}  // namespace manylight::reference
