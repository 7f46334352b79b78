// SPDX-License-Identifier: MIT
// Image files for textures.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace manylight {

/// Pixels as a file stores them: rows from the top, RGBA, colours not multiplied by alpha. A
/// missing alpha is 1, and grey is all three colours. Of 8 bits where the file has no more,
/// otherwise floats. Either of the two is empty.
struct DecodedImage {
    unsigned width = 0;
    unsigned height = 0;
    std::vector<std::uint8_t> bytes;  // [4 * (y * width + x) + channel], 255 for 1
    std::vector<float> floats;        // likewise
    bool linear = false;              // the file itself says that its colours are, as .exr do
};

/// The largest image that is decoded: texels along a side, and in all.
constexpr unsigned most_texels_along_side = 16384;
constexpr std::size_t most_texels = std::size_t{1} << 26;

/// Decodes a PNG, JPEG, WebP or OpenEXR file's bytes, whatever it is named. Size and channels are
/// checked before anything is allocated for them. Throws InputError that starts with `where` (the
/// file and the object) where the bytes are no such image, broken or larger than allowed.
[[nodiscard]] DecodedImage decode_image(std::span<const unsigned char> bytes,
                                        const std::string& where);

}  // namespace manylight
