// SPDX-License-Identifier: MIT
// A receiver as lib/node_estimate.h takes it.
#ifndef MANYLIGHT_LIB_POINTS_H
#define MANYLIGHT_LIB_POINTS_H

static Points_1 point_of(const Receiver* r) {
    Points_1 p;
    p.px = r->position.x;
    p.py = r->position.y;
    p.pz = r->position.z;
    p.nx = r->normal.x;
    p.ny = r->normal.y;
    p.nz = r->normal.z;
    p.red = r->material.base_color.x;
    p.green = r->material.base_color.y;
    p.blue = r->material.base_color.z;
#if HAS_GGX
    p.vx = r->to_camera.x;
    p.vy = r->to_camera.y;
    p.vz = r->to_camera.z;
    p.metallic = r->material.base_color.w;
    p.alpha = r->material.roughness;
    p.specular = r->material.specular;
#if HAS_REFLECTANCE
    p.f0_red = r->material.reflectance.x;
    p.f0_green = r->material.reflectance.y;
    p.f0_blue = r->material.reflectance.z;
#endif
    p.glossy = p.metallic > 0.0f || p.specular > 0.0f;
#endif
    return p;
}

#endif
