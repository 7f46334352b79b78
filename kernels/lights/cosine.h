// SPDX-License-Identifier: MIT
// Lights that shine by the cosine to their normal (Lambert).

#if FOR_RECEIVER
// Intensity I along the normal gives I cos / d^2. `normal` may have any length, which scales;
// shadow rays end `offset` before the emitter. Normalises the direction and returns cos / d^2.
static float emit_cosine(LightSample* s, float3 intensity, float3 normal, float offset,
                         bool both_sides) {
    const float squared = dot(s->direction, s->direction);
    if (squared == 0.0f) return 0.0f;
    s->direction *= 1.0f / sqrt(squared);
    float cosine = -dot(s->direction, normal);
    if (cosine < 0.0f && both_sides) {
        cosine = -cosine;
        normal = -normal;
    }
    if (cosine <= 0.0f) return 0.0f;
    s->emitted = intensity * (cosine / squared);
    const float largest = max(max(fabs(normal.x), fabs(normal.y)), fabs(normal.z));
    s->target += normalize(normal / largest) * offset;  // whose square may be too small for a float
    return cosine / squared;
}
#endif

#if FOR_LANES
// The same, of intensity 1: returns the cosine where the light shines, or else 0. `both` are the
// lanes whose lights do to both sides.
INLINE float_n emit_cosine_n(LightSample_n* s, float_n nx, float_n ny, float_n nz, float_n offset,
                             int_n both) {
    const float_n cosine = -dot3_n(s->wx, s->wy, s->wz, nx, ny, nz);
    // The square of a small area would be too small for a float.
    const float_n scale = inverse_n(max(max(max(fabs(nx), fabs(ny)), fabs(nz)), 1e-30f));
    nx *= scale;
    ny *= scale;
    nz *= scale;
    const float_n length = offset * inverse_root_n(max(dot3_n(nx, ny, nz, nx, ny, nz), 1e-30f));
    const float_n side = select(length, -length, cosine < 0.0f);
    s->x += nx * side;
    s->y += ny * side;
    s->z += nz * side;
    return select(max(cosine, (float_n)(0.0f)), fabs(cosine), both);
}
#endif
