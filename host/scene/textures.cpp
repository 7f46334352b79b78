// SPDX-License-Identifier: MIT
#include "scene/textures.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/gtc/packing.hpp>

#include "error.hpp"

namespace manylight {
namespace {

constexpr float largest_half = 65504;

// IEC 61966-2-1.
float decode_srgb(float v) {
    return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
}

float encode_srgb(float v) {
    return v <= 0.0031308f ? v * 12.92f : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f;
}

std::size_t words_per_texel(std::uint32_t format) { return format == TEXELS_HALF ? 2 : 1; }

unsigned side_of(unsigned finest, unsigned level) { return std::max(finest >> level, 1u); }

// The word at which a level starts.
std::size_t level_start(const Texture& t, unsigned level) {
    std::size_t texels = 0;
    for (unsigned i = 0; i < level; ++i)
        texels += std::size_t{side_of(t.width, i)} * side_of(t.height, i);
    return t.first + texels * words_per_texel(t.format);
}

glm::vec4 load(const std::uint32_t* words, std::uint32_t format) {
    if (format == TEXELS_HALF)
        return {glm::unpackHalf2x16(words[0]), glm::unpackHalf2x16(words[1])};
    static const std::array<float, 256> decoded = [] {
        std::array<float, 256> table{};
        for (std::size_t i = 0; i < 256; ++i) table[i] = decode_srgb(static_cast<float>(i) / 255.f);
        return table;
    }();
    glm::vec4 texel;
    for (int c = 0; c < 4; ++c) {
        const std::uint32_t byte = words[0] >> (8 * c) & 255;
        texel[c] =
            format == TEXELS_SRGB && c < 3 ? decoded[byte] : static_cast<float>(byte) / 255.f;
    }
    return texel;
}

void store(glm::vec4 texel, std::uint32_t format, std::uint32_t* words) {
    if (format == TEXELS_HALF) {
        words[0] = glm::packHalf2x16({texel.r, texel.g});
        words[1] = glm::packHalf2x16({texel.b, texel.a});
        return;
    }
    words[0] = 0;
    for (int c = 0; c < 4; ++c) {
        const float value = format == TEXELS_SRGB && c < 3 ? encode_srgb(texel[c]) : texel[c];
        const auto byte =
            static_cast<std::uint32_t>(std::lround(std::clamp(value, 0.f, 1.f) * 255));
        words[0] |= byte << (8 * c);
    }
}

// The texels of a finer level's side that texel x of the next one covers, with their shares.
struct Covered {
    unsigned first;
    std::array<float, 3> shares;
};
Covered covered(unsigned x, unsigned side, unsigned finer) {
    const double begin = static_cast<double>(x) * finer / side;
    const double end = static_cast<double>(x + 1) * finer / side;
    Covered out{static_cast<unsigned>(begin), {}};
    for (unsigned i = 0; i < 3; ++i) {
        const double lower = std::max<double>(begin, out.first + i);
        const double upper = std::min<double>(end, out.first + i + 1);
        out.shares[i] = static_cast<float>(std::max(upper - lower, 0.0) / (end - begin));
    }
    return out;
}

glm::vec4 mean(const Scene& scene, const Texture& t, unsigned level, const Covered& x,
               const Covered& y, bool weighted) {
    glm::vec4 plain(0);
    glm::vec3 by_alpha(0);
    for (unsigned j = 0; j < 3; ++j)
        for (unsigned i = 0; i < 3; ++i) {
            const float share = x.shares[i] * y.shares[j];
            if (share == 0) continue;
            const glm::vec4 texel = texel_of(scene, t, level, x.first + i, y.first + j);
            plain += share * texel;
            by_alpha += share * texel.a * glm::vec3(texel);
        }
    return weighted && plain.a > 0 ? glm::vec4(by_alpha / plain.a, plain.a) : plain;
}

void add_level(Scene& scene, const Texture& t, unsigned level, bool weighted) {
    const unsigned width = side_of(t.width, level);
    const unsigned height = side_of(t.height, level);
    const std::size_t words = words_per_texel(t.format);
    const std::size_t start = scene.texels.size();
    scene.texels.resize(start + std::size_t{width} * height * words);
    for (unsigned y = 0; y < height; ++y) {
        const Covered rows = covered(y, height, side_of(t.height, level - 1));
        for (unsigned x = 0; x < width; ++x)
            store(mean(scene, t, level - 1, covered(x, width, side_of(t.width, level - 1)), rows,
                       weighted),
                  t.format, &scene.texels[start + (std::size_t{y} * width + x) * words]);
    }
}

void add_finest(Scene& scene, const DecodedImage& image, TexelMeaning meaning,
                const std::string& where) {
    for (std::size_t i = 0; i < image.bytes.size(); i += 4)
        scene.texels.push_back(image.bytes[i] | image.bytes[i + 1] << 8 | image.bytes[i + 2] << 16 |
                               static_cast<std::uint32_t>(image.bytes[i + 3]) << 24);
    for (std::size_t i = 0; i < image.floats.size(); i += 4) {
        glm::vec4 texel;
        for (int c = 0; c < 4; ++c) {
            texel[c] = image.floats[i + static_cast<std::size_t>(c)];
            if (!(texel[c] >= 0 && texel[c] <= largest_half))
                throw InputError("{}: texel ({}, {}) has the value {}, not one of 0 to {}", where,
                                 i / 4 % image.width, i / 4 / image.width, texel[c], largest_half);
            if (meaning.color && !image.linear && c < 3) texel[c] = decode_srgb(texel[c]);
        }
        scene.texels.resize(scene.texels.size() + 2);
        store(texel, TEXELS_HALF, &scene.texels[scene.texels.size() - 2]);
    }
}

// The texel of a side of n that is shown at x.
unsigned shown(double x, unsigned n, std::uint32_t wrap) {
    if (wrap == WRAP_CLAMP) return static_cast<unsigned>(std::clamp(x * n, 0.0, n - 1.0));
    double place = x - 2 * std::floor(x / 2);  // all modes repeat after 2
    if (place >= 1) place = wrap == WRAP_MIRROR ? 2 - place : place - 1;
    return std::min(static_cast<unsigned>(place * n), n - 1);
}

}  // namespace

Texture add_texels(Scene& scene, const DecodedImage& image, TexelMeaning meaning,
                   const std::string& where) {
    Texture out{};
    out.width = image.width;
    out.height = image.height;
    out.levels = static_cast<unsigned>(std::bit_width(std::max(image.width, image.height)));
    out.format = image.bytes.empty() ? TEXELS_HALF : meaning.color ? TEXELS_SRGB : TEXELS_LINEAR;
    const std::size_t words =
        std::size_t{image.width} * image.height * 2 * words_per_texel(out.format);
    if (scene.texels.size() + words > 0xffffffffu)
        throw InputError("{}: the scene's textures have more than 16 GiB", where);
    out.first = static_cast<std::uint32_t>(scene.texels.size());
    add_finest(scene, image, meaning, where);
    for (unsigned level = 1; level < out.levels; ++level)
        add_level(scene, out, level, meaning.weighted);
    return out;
}

glm::dvec4 finest_texel(const Scene& scene, const Texture& t, glm::dvec2 uv) {
    const glm::dvec2 size(t.width, t.height);
    const auto texel = [&](glm::dvec2 at) {
        return glm::dvec4(
            texel_of(scene, t, 0, shown(at.x, t.width, t.wrap_u), shown(at.y, t.height, t.wrap_v)));
    };
    if (t.magnified_linear == 0) return texel(uv);
    const glm::dvec2 corner = glm::floor(uv * size - 0.5) + 0.5;  // the centre of a texel
    const glm::dvec2 share = uv * size - corner;
    const auto row = [&](double y) {
        return glm::mix(texel((corner + glm::dvec2(0, y)) / size),
                        texel((corner + glm::dvec2(1, y)) / size), share.x);
    };
    return glm::mix(row(0), row(1), share.y);
}

TextureLevel::TextureLevel(const Scene& scene, const Texture& texture, glm::dvec2 u, glm::dvec2 v)
    : scene_(scene), texture_(texture) {
    const double area = std::abs(u.x * v.y - u.y * v.x) * texture.width * texture.height;
    const double octaves = std::round(0.5 * std::log2(std::max(area, 1e-30)));
    level_ = static_cast<unsigned>(std::clamp<double>(octaves, 0, texture.levels - 1));
}

glm::dvec3 TextureLevel::at(glm::dvec2 uv) const {
    return glm::dvec3(texel_of(scene_, texture_, level_,
                               shown(uv.x, side_of(texture_.width, level_), texture_.wrap_u),
                               shown(uv.y, side_of(texture_.height, level_), texture_.wrap_v)));
}

glm::vec4 texel_of(const Scene& scene, const Texture& texture, unsigned level, unsigned x,
                   unsigned y) {
    const std::size_t texel = std::size_t{y} * side_of(texture.width, level) + x;
    return load(
        &scene.texels[level_start(texture, level) + texel * words_per_texel(texture.format)],
        texture.format);
}

}  // namespace manylight
