// SPDX-License-Identifier: MIT
// A point of a surface that shines. Leaves of the light tree are estimated as groups are.

#if FOR_RECEIVER && HAS_ORIENTED
static LightSample light_oriented(__global const Light* light, float3 position, float2 u) {
    LightSample s = sample_towards(position, light->position.xyz);
    emit_cosine(&s, light->emission.xyz, light->axis.xyz, light->edge.w, false);
    return s;
}
#endif

#if FOR_LANES && HAS_ORIENTED
INLINE LightSample_n light_oriented_n(const Lights_n* l, const Points_n* p, const Origins_n* from,
                                      float_n u, float_n v) {
    LightSample_n s = sample_towards_n(p, l->x, l->y, l->z);
    const float_n facing = emit_cosine_n(&s, l->ax, l->ay, l->az, l->ew, (int_n)(0));
    s.emitted = facing * (s.inverse * s.inverse);
    return s;
}
#endif
