// SPDX-License-Identifier: MIT
// A point that shines evenly. Leaves of the light tree: lights/punctual.h.

#if FOR_RECEIVER && HAS_POINT
static LightSample light_point(__global const Light* light, float3 position, float2 u) {
    LightSample s = sample_towards(position, light->position.xyz);
    s.emitted = light->emission.xyz * punctual_falloff(&s, light->axis.w);
    return s;
}
#endif

#if FOR_LANES && HAS_POINT
INLINE LightSample_n light_point_n(const Lights_n* l, const Points_n* p, const Origins_n* from,
                                   float_n u, float_n v) {
    LightSample_n s = sample_towards_n(p, l->x, l->y, l->z);
    s.emitted = punctual_window_n(l, s.squared) * (s.inverse * s.inverse);
    return s;
}
#endif
