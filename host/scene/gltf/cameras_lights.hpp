// SPDX-License-Identifier: MIT
#pragma once

#include "scene/gltf/loading.hpp"

namespace manylight {

/// Adds the camera of a node that has one.
void add_camera(Loading& in, int node);

/// Adds the light of a node (KHR_lights_punctual), if it has one, unless it is black or scaled
/// away. Throws InputError for one out of range.
void add_light(Loading& in, int node);

}  // namespace manylight
