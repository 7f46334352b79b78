// SPDX-License-Identifier: MIT
// The camera's image plane: where rays to points begin, and how much a pixel sees of what.
#ifndef MANYLIGHT_LIB_FILM_H
#define MANYLIGHT_LIB_FILM_H

#include "lib/common.h"
#include "shared/camera.h"
#include "shared/tiles.h"

// Unit normal of the image plane, along the view.
static float3 film_normal(Camera camera) {
    const float3 normal = normalize(cross(camera.right.xyz, camera.up.xyz));
    return dot(normal, camera.forward.xyz) < 0.0f ? -normal : normal;
}

// The area of a surface, with that unit normal, that a pixel sees at a distance along its ray of
// unit `direction`.
static float seen_area(Tiles tiles, Camera camera, float3 direction, float distance,
                       float3 normal) {
    const float3 image = cross(camera.right.xyz, camera.up.xyz);  // a quarter, at distance 1
    const float pixel = 4.0f * length(image) / ((float)tiles.width * (float)tiles.height);
    const float forward = dot(film_normal(camera), direction);
    const float enlarged =
        camera.forward.w != 0.0f ? 1.0f : forward * forward * forward * distance * distance;
    return pixel * enlarged / fabs(dot(normal, direction));
}

// Where the ray to a point that the camera sees meets the near plane.
static float3 film_start(Camera camera, float3 position) {
    const float3 normal = film_normal(camera);
    const float3 from = position - camera.origin.xyz;
    const float depth = dot(normal, from) / dot(normal, camera.forward.xyz);
    const float near = camera.right.w;
    return camera.origin.xyz + (camera.forward.w != 0.0f
                                    ? from - camera.forward.xyz * (depth - near)
                                    : from * (near / depth));
}

#endif
