// SPDX-License-Identifier: MIT
#ifndef MANYLIGHT_LIB_CAMERA_H
#define MANYLIGHT_LIB_CAMERA_H

#include "lib/common.h"
#include "shared/camera.h"

// Unit direction from a point that the camera sees back to it.
static float3 direction_to_camera(Camera camera, float3 position) {
    return camera.forward.w != 0.0f ? -camera.forward.xyz : normalize(camera.origin.xyz - position);
}

#endif
