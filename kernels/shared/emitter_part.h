// SPDX-License-Identifier: MIT
#ifndef MANYLIGHT_SHARED_EMITTER_PART_H
#define MANYLIGHT_SHARED_EMITTER_PART_H

#include "shared/types.h"

SHARED_BEGIN

/// A triangle of what one pixel's square covers of an emissive triangle. On the film, the point u,
/// v of it is corner 0 + u (corner 1 - corner 0) + v (corner 2 - corner 0). The weights of the
/// emissive triangle's vertices 1 and 2 are there `corner` + (u nearer_1 way_1 + v nearer_2 way_2)
/// / (1 - u - v + u nearer_1 + v nearer_2), where the camera has perspective, and else as if
/// `nearer` were 1.
typedef struct EmitterPart {
    float4 corner;  // xy: of its corner 0; zw: way_1, from there to corner 1
    float4 way_2;   // xy; z: nearer_1, the depth of corner 0 over that of corner 1; w: nearer_2
    float covered;  // of the pixel, 0 to 1
    uint triangle;  // of the scene's own, none of an instance
    uint pixel;     // y * width + x
    uint padding;
} EmitterPart;
SHARED_SIZE(EmitterPart, 48)

SHARED_END

#endif
