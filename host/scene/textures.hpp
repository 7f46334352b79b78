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

/// What a texture shows at coordinates, at its finest level, by its filter for that. Linear.
[[nodiscard]] glm::dvec4 finest_texel(const Scene& scene, const Texture& texture, glm::dvec2 uv);

/// The level of a texture that resolves points which are u and v apart, in its coordinates.
class TextureLevel {
  public:
    TextureLevel(const Scene& scene, const Texture& texture, glm::dvec2 u, glm::dvec2 v);
    /// The texel at coordinates. Linear.
    [[nodiscard]] glm::dvec3 at(glm::dvec2 uv) const;

  private:
    const Scene& scene_;
    const Texture& texture_;
    unsigned level_;
};

}  // namespace manylight
