// SPDX-License-Identifier: MIT
// Lights at a point: the falloff that KHR_lights_punctual recommends.

#if FOR_RECEIVER
// Normalises the direction.
static float punctual_falloff(LightSample* s, float range) {
    const float squared = dot(s->direction, s->direction);
    if (squared == 0.0f) return 0.0f;
    s->direction *= 1.0f / sqrt(squared);
    if (range == 0.0f) return 1.0f / squared;
    const float ratio = squared / (range * range);
    return clamp(1.0f - ratio * ratio, 0.0f, 1.0f) / squared;
}
#endif

#if FOR_LANES
// Times the squared distance.
INLINE float_n punctual_window_n(const Lights_n* l, float_n squared) {
    const float_n ratio = squared * inverse_n(clamp(l->aw * l->aw, 1e-30f, 1e30f));
    return select(clamp(1.0f - ratio * ratio, 0.0f, 1.0f), (float_n)(1.0f), l->aw == 0.0f);
}
#endif

#if FOR_NODES && HAS_RANGE
INLINE REAL NODE_NAMED(node_window)(const NODE* node, REAL distance2) {
    const REAL ratio = distance2 * node->falloff;
    return clamp(1.0f - ratio * ratio, 0.0f, 1.0f);
}
#endif
