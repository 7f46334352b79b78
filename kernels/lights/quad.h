// SPDX-License-Identifier: MIT
// A parallelogram. Leaves of the light tree: lights/area.h.

#if FOR_RECEIVER && HAS_QUAD
static LightSample light_quad(__global const Light* light, float3 position, float2 u) {
    return light_area(light, position, u, 1.0f);
}
#endif

#if FOR_LANES && HAS_QUAD
INLINE LightSample_n light_quad_n(const Lights_n* l, const Points_n* p, const Origins_n* from,
                                  float_n u, float_n v) {
    return light_area_n(l, p, from, u, v, 1.0f);
}
#endif
