// SPDX-License-Identifier: MIT
// Images to the texels of a scene.
#pragma once

#include "scene/decode.hpp"
#include "scene/scene.hpp"

namespace manylight {

/// What the channels of an image are.
struct TexelMeaning {
    bool color = false;     // RGB are colours, encoded as sRGB unless the file says otherwise
    bool weighted = false;  // ... and count by alpha where texels are averaged
    // The factor of the glossiness in A, of which they are to say roughness and metal as glTF does;
    // negative: none.
    float glossiness = -1;
    auto operator<=>(const TexelMeaning&) const = default;
};

/// Adds an image's texels to the scene, finest level first, and returns where they are: `first`,
/// `width`, `height`, `levels` and `format` of a Texture. A texel of the next level is the mean of
/// those that it covers, in linear colour. Throws InputError that starts with `where` for values
/// that are no colours: negative, not finite or beyond 65504.
[[nodiscard]] Texture add_texels(Scene& scene, const DecodedImage& image, TexelMeaning meaning,
                                 const std::string& where);

/// A texel of a level, linear.
[[nodiscard]] glm::vec4 texel_of(const Scene& scene, const Texture& texture, unsigned level,
                                 unsigned x, unsigned y);

/// The mean of a texture over the parallelogram, or the triangle, of u and v at `corner`, by the
/// texels at 16 x 16 points of it at the level that resolves these. Linear.
[[nodiscard]] glm::dvec4 mean_of_part(const Scene& scene, const Texture& texture, glm::dvec2 corner,
                                      glm::dvec2 u, glm::dvec2 v, bool triangle);

}  // namespace manylight
