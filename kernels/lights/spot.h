// SPDX-License-Identifier: MIT
// A point that shines in a cone: KHR_lights_punctual's angular attenuation, by 1 - cosine
// (shared/light.h).

#if FOR_RECEIVER && HAS_SPOT
static LightSample light_spot(__global const Light* light, float3 position, float2 u) {
    LightSample s = sample_towards(position, light->position.xyz);
    const float falloff = punctual_falloff(&s, light->axis.w);
    const float3 across = cross(s.direction, light->axis.xyz);
    const float versine = versine_of(-dot(s.direction, light->axis.xyz), dot(across, across));
    const float cone = clamp((light->edge.y - versine) * light->edge.x, 0.0f, 1.0f);
    s.emitted = light->emission.xyz * (falloff * cone * cone);
    return s;
}
#endif

#if FOR_LANES && HAS_SPOT
INLINE LightSample_n light_spot_n(const Lights_n* l, const Points_n* p, const Origins_n* from,
                                  float_n u, float_n v) {
    LightSample_n s = sample_towards_n(p, l->x, l->y, l->z);
    const float_n off_axis = -dot3_n(s.wx, s.wy, s.wz, l->ax, l->ay, l->az);
    const float_n versine = versine_n(off_axis, s.wx, s.wy, s.wz, l->ax, l->ay, l->az);
    const float_n cone = clamp((l->ey - versine) * l->ex, 0.0f, 1.0f);
    s.emitted = punctual_window_n(l, s.squared) * cone * cone * (s.inverse * s.inverse);
    return s;
}
#endif

#if FOR_NODES && HAS_CONE
// `along`: the cosine off the axis of the unit direction w to the light.
INLINE REAL NODE_NAMED(node_cone)(const NODE* node, REAL along, REAL wx, REAL wy, REAL wz) {
    const REAL versine =
        NAMED(versine)(along, wx, wy, wz, (REAL)(node->ax), (REAL)(node->ay), (REAL)(node->az));
    const REAL cone = clamp((node->outer - versine) * node->scale, 0.0f, 1.0f);
    return cone * cone;
}
#endif
