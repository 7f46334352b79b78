// SPDX-License-Identifier: MIT
// Lambert's lobe. Included as material/ggx.h is.

#if FOR_RECEIVER
// 1/sr.
static float3 lambert(Material m) { return m.base_color.xyz * M_1_PI_F; }
#endif

#if FOR_POINTS
// Times `factor`.
INLINE NAMED(Color) NAMED(lambert)(const NAMED(Points) * p, REAL factor) {
    NAMED(Color) c;
    factor *= M_1_PI_F;
    c.red = factor * p->red;
    c.green = factor * p->green;
    c.blue = factor * p->blue;
    return c;
}
#endif
