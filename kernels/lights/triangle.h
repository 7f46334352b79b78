// SPDX-License-Identifier: MIT
// A triangle: half of a parallelogram, whose other half is turned onto it. Leaves of the light
// tree: lights/area.h.

#if FOR_RECEIVER && HAS_TRIANGLE
static LightSample light_triangle(__global const Light* light, float3 position, float2 u) {
    if (u.x + u.y > 1.0f) u = 1.0f - u;
    return light_area(light, position, u, 0.5f);
}
#endif

#if FOR_LANES && HAS_TRIANGLE
INLINE LightSample_n light_triangle_n(const Lights_n* l, const Points_n* p, const Origins_n* from,
                                      float_n u, float_n v) {
    const int_n beyond = u + v > 1.0f;
    return light_area_n(l, p, from, select(u, 1.0f - u, beyond), select(v, 1.0f - v, beyond), 0.5f);
}
#endif
