// SPDX-License-Identifier: MIT
// Lights with area: the parallelogram of axis and edge, or a part of it.

#if FOR_RECEIVER
// The point u of the parallelogram of axis and edge, `share` of which emits; the normal's length is
// the parallelogram's area.
static LightSample light_area(__global const Light* light, float3 position, float2 u, float share) {
    const float3 axis = light->axis.xyz;
    const float3 edge = light->edge.xyz;
    LightSample s = sample_towards(position, light->position.xyz + axis * u.x + edge * u.y);
    s.solid_angle = share * emit_cosine(&s, light->emission.xyz * share, cross(axis, edge),
                                        light->edge.w, light->axis.w != 0.0f);
    return s;
}
#endif

#if FOR_LANES
// The same.
INLINE LightSample_n light_area_n(const Lights_n* l, const Points_n* p, const Origins_n* from,
                                  float_n u, float_n v, float share) {
    LightSample_n s = sample_towards_n(p, l->x + l->ax * u + l->ex * v,
                                       l->y + l->ay * u + l->ey * v, l->z + l->az * u + l->ez * v);
    const float_n nx = l->ay * l->ez - l->az * l->ey;
    const float_n ny = l->az * l->ex - l->ax * l->ez;
    const float_n nz = l->ax * l->ey - l->ay * l->ex;
    const float_n facing = share * emit_cosine_n(&s, nx, ny, nz, l->ew, l->aw != 0.0f);
    s.emitted = facing * (s.inverse * s.inverse);
    s.solid_angle = facing * s.inverse * s.inverse * from->reflects;
    return s;
}
#endif

#if FOR_NODES && HAS_AREA
// `along`: the cosine between the axis and the unit direction to the centre; 1 / `inverse`: the
// distance; `softened`: 1 / squared distance, with the spread.
INLINE REAL NODE_NAMED(node_area)(const NODE* node, REAL along, REAL distance2, REAL inverse,
                                  REAL softened) {
    // The height over the emitter's plane: the same, whichever of its points is seen.
    const REAL height = along * distance2 * inverse;
    const REAL above = WHERE_NODE(node->iso > 0.0f, fabs(height), max(height, (REAL)(0.0f)));
    return above * NAMED(root)(softened);
}
#endif
