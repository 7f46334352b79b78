// SPDX-License-Identifier: MIT
// Where the light of receivers goes: to the camera, or along outgoing[item] with a throughput.
#ifndef MANYLIGHT_LIB_VIEW_H
#define MANYLIGHT_LIB_VIEW_H

#include "lib/common.h"
#include "shared/camera.h"
#include "shared/surface.h"

// A kernel that lights receivers takes VIEW_PARAMETERS and hands VIEW on, as a View.
#if HAS_OUTGOING
#define VIEW_PARAMETERS __global const Outgoing* outgoing
#define VIEW outgoing
typedef __global const Outgoing* View;
#else
#define VIEW_PARAMETERS Camera camera
#define VIEW camera
typedef Camera View;
#endif

// Unit direction from a point that the camera sees back to it.
static float3 direction_to_camera(Camera camera, float3 position) {
    return camera.forward.w != 0.0f ? -camera.forward.xyz : normalize(camera.origin.xyz - position);
}

#endif
