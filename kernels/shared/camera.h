// SPDX-License-Identifier: MIT
#ifndef MANYLIGHT_SHARED_CAMERA_H
#define MANYLIGHT_SHARED_CAMERA_H

#include "shared/types.h"

SHARED_BEGIN

/// A pinhole or orthographic camera in world space (metres).
///
/// The ray through the image point (x, y), in pixels from the top left corner of a width x height
/// image, has sx = 2x/width - 1 and sy = 1 - 2y/height. Perspective: it starts at `origin` towards
/// forward + sx right + sy up. Orthographic: it starts at origin + sx right + sy up towards
/// forward. It sees what is between two planes across its view.
typedef struct Camera {
    float4 origin;   // xyz
    float4 right;    // xyz: half the image's width, at distance 1 where perspective; w: distance of
                     // the near plane, m
    float4 up;       // xyz: half the image's height, likewise; w: distance of the far plane, m, 0
                     // if none
    float4 forward;  // xyz: unit but for a shift, w: 1 orthographic, 0 perspective
} Camera;
SHARED_SIZE(Camera, 64)

SHARED_END

#endif
