// SPDX-License-Identifier: MIT
// Parallel light from infinitely far, or from a plane across it. Nodes of the light tree:
// node_directions() in lib/node_estimate.h.

#if FOR_RECEIVER && HAS_DIRECTIONAL
static LightSample light_directional(__global const Light* light, float3 position, float2 u) {
    LightSample s;
    s.direction = -light->axis.xyz;
    s.target = (float3)(0.0f);
    s.emitted = light->emission.xyz;
    s.solid_angle = 0.0f;
    s.infinite = true;
    s.plane = light->edge.y == 0.0f ? -INFINITY : light->edge.x;
    return s;
}
#endif

#if FOR_LANES && HAS_DIRECTIONAL
INLINE LightSample_n light_directional_n(const Lights_n* l, const Points_n* p,
                                         const Origins_n* from, float_n u, float_n v) {
    LightSample_n s = sample_towards_n(p, l->x, l->y, l->z);
    s.wx = -l->ax;
    s.wy = -l->ay;
    s.wz = -l->az;
    s.emitted = (float_n)(1.0f);
    s.x = s.wx;
    s.y = s.wy;
    s.z = s.wz;
    const float_n to_plane = dot3_n(l->ax, l->ay, l->az, from->x, from->y, from->z) - l->ex;
    s.end = select(max(to_plane, 1e-30f), (float_n)(INFINITY), l->ey == 0.0f);
    return s;
}
#endif
