// SPDX-License-Identifier: MIT
#pragma once

#include "scene/scene.hpp"

namespace manylight {

/// Fills alpha_triangles and alpha_of with the triangles that rays may pass, by their materials,
/// textures and vertex colours.
void find_alpha(Scene& scene);

/// Makes every surface that is partly there one that is there where its alpha is 0.5 at least.
void mask_all_alpha(Scene& scene);

}  // namespace manylight
