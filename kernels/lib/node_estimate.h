// SPDX-License-Identifier: MIT
// What a light tree's node contributes to surface points if nothing is in between: an estimate,
// exact for a single point light, positive wherever a contribution is possible.
//
// Included for a node and a point, with WIDE_POINTS 1 for a node and LANES points, and with
// WIDE_NODES 1, too, for LANES nodes, each with a point of its own. Names end in _1, _n and _n_n
// then.
#include "lib/inverse.h"

#ifndef WIDE_POINTS
#define WIDE_POINTS 0
#endif
#ifndef WIDE_NODES
#define WIDE_NODES 0
#endif
#if !WIDE_POINTS
#define REAL float
#define NAMED(name) name##_1
#define WHERE(condition, yes, no) ((condition) ? (yes) : (no))
#else
#define REAL float_n
#define NAMED(name) name##_n
#define WHERE(condition, yes, no) select(no, yes, condition)
#endif
#if !WIDE_NODES
#define NODE Node_1
#define NODE_REAL float
#define NODE_MASK int
#define NODE_NAMED(name) NAMED(name)
#define NODE_HAS light_has
#define ANY_NODE(mask) (mask)
#define WHERE_NODE(mask, yes, no) ((mask) ? (yes) : (no))
#else
#define NODE Node_n
#define NODE_REAL float_n
#define NODE_MASK int_n
#define NODE_NAMED(name) name##_n_n
#define NODE_HAS light_has_n
#define ANY_NODE(mask) (lanes_n(mask) != 0u)
#define WHERE_NODE(mask, yes, no) select(no, yes, mask)
#endif

#if !WIDE_POINTS || WIDE_NODES
// A node of the light tree, or LANES of them, with what is needed of their lights.
typedef struct NODE {
    NODE_REAL x, y, z, spread;           // mean position, mean squared distance to it
    NODE_REAL ax, ay, az;                // mean axis; of an emitter with area its unit normal
    NODE_REAL iso;                       // the share of light without axis; two sides: above 0
    NODE_REAL red, green, blue, radius;  // intensity; all lights are so close to the mean position
#if HAS_RANGE
    NODE_REAL falloff;  // 1 / range^2, 0 without a range
#endif
#if HAS_CONE
    NODE_REAL scale, outer;  // Light::edge.x and y, 1 and 3 without a cone
    NODE_REAL reach;         // of a group
#endif
#if !WIDE_NODES
    uint kind;
#else
    uint_n kind;
#endif
} NODE;
#endif

#if !WIDE_POINTS
// 1 / range^2, 0 where there is no range.
static float inverse_square(float range) { return range > 0.0f ? 1.0f / (range * range) : 0.0f; }

static Node_1 load_node(__global const LightNode* node, __global const Light* lights) {
    Node_1 n;
    n.x = node->centre.x;
    n.y = node->centre.y;
    n.z = node->centre.z;
    n.spread = node->centre.w;
    n.ax = node->axis.x;
    n.ay = node->axis.y;
    n.az = node->axis.z;
    n.iso = node->axis.w;
    n.red = node->intensity.x;
    n.green = node->intensity.y;
    n.blue = node->intensity.z;
    n.radius = node->intensity.w;
    n.kind = node->kind;
#if HAS_RANGE
    n.falloff = light_has(n.kind, TRAIT_RANGE) ? inverse_square(lights[node->first].axis.w) : 0.0f;
#endif
#if HAS_CONE
    n.scale = light_has(n.kind, TRAIT_CONE) ? lights[node->first].edge.x : 1.0f;
    n.outer = light_has(n.kind, TRAIT_CONE) ? lights[node->first].edge.y : 3.0f;
    n.reach = node->reach;
#endif
    return n;
}
#elif WIDE_NODES
// light_has() of the lanes' kinds; `trait` is known when this is compiled.
INLINE int_n light_has_n(uint_n kind, uint trait) {
#define LIGHT_KIND_HAS(name, NAME, value, traits, centroid) \
    | (((traits)&trait) != 0u ? kind == value : (int_n)(0))
    return (int_n)(0)LIGHT_KINDS(LIGHT_KIND_HAS);
#undef LIGHT_KIND_HAS
}

// The nodes of all lanes, with their numbers of lights and the first of these.
INLINE Node_n load_nodes_n(__global const LightNode* nodes, __global const Light* lights,
                           uint_n indices, uint_n* first, uint_n* count) {
    float_n rows[16];
    load_columns((__global const float*)nodes, sizeof(LightNode) / sizeof(float), indices, rows);
    *first = as_uint_n(rows[12]);
    *count = as_uint_n(rows[13]);
    Node_n n;
    n.x = rows[0];
    n.y = rows[1];
    n.z = rows[2];
    n.spread = rows[3];
    n.ax = rows[4];
    n.ay = rows[5];
    n.az = rows[6];
    n.iso = rows[7];
    n.red = rows[8];
    n.green = rows[9];
    n.blue = rows[10];
    n.radius = rows[11];
    n.kind = as_uint_n(rows[15]);
    // What single lights have of their own.
#if HAS_RANGE
    n.falloff = (float_n)(0.0f);
    for (uint lanes = lanes_n(light_has_n(n.kind, TRAIT_RANGE)); lanes; lanes &= lanes - 1u) {
        const uint lane = lowest(lanes);
        SET_LANE(n.falloff, lane, inverse_square(lights[UINT_LANE(*first, lane)].axis.w));
    }
#endif
#if HAS_CONE
    n.reach = rows[14];
    n.scale = (float_n)(1.0f);
    n.outer = (float_n)(3.0f);
    for (uint lanes = lanes_n(light_has_n(n.kind, TRAIT_CONE)); lanes; lanes &= lanes - 1u) {
        const uint lane = lowest(lanes);
        __global const Light* light = lights + UINT_LANE(*first, lane);
        SET_LANE(n.scale, lane, light->edge.x);
        SET_LANE(n.outer, lane, light->edge.y);
    }
#endif
    return n;
}
#endif

#if !WIDE_NODES
#include "lib/reflect.h"
#endif

#define FOR_NODES 1
#include "lights/kinds.h"
#undef FOR_NODES

// The lights' part: their intensity's factor and the unit direction to their centre. 0 where none
// of them can be above the surface.
INLINE REAL NODE_NAMED(node_geometry)(const NODE* node, const NAMED(Points) * p, REAL* wx, REAL* wy,
                                      REAL* wz, REAL* spread) {
    const REAL dx = node->x - p->px, dy = node->y - p->py, dz = node->z - p->pz;
    const REAL distance2 = NAMED(dot3)(dx, dy, dz, dx, dy, dz);
    const REAL inverse = NAMED(inverse_root)(max(distance2, (REAL)(1e-30f)));
    *wx = dx * inverse;
    *wy = dy * inverse;
    *wz = dz * inverse;
    const REAL softened = NAMED(inverse)(max(distance2 + node->spread, (REAL)(1e-30f)));  // 1 / e^2
    *spread = node->spread * softened;
    const REAL k = NAMED(dot3)(p->nx, p->ny, p->nz, *wx, *wy, *wz);
    const REAL incidence = NAMED(soft)(k, *spread) * softened;
    REAL emission = (REAL)(1.0f);
    const REAL along =
        -NAMED(dot3)((REAL)(node->ax), (REAL)(node->ay), (REAL)(node->az), *wx, *wy, *wz);
#if HAS_RANGE
    if (ANY_NODE(node->falloff > 0.0f)) emission = NODE_NAMED(node_window)(node, distance2);
#endif
#if HAS_CONE
    if (ANY_NODE(NODE_HAS(node->kind, TRAIT_CONE)))
        emission *= NODE_NAMED(node_cone)(node, along, *wx, *wy, *wz);
#endif
#if HAS_AREA
    const NODE_MASK area = NODE_HAS(node->kind, TRAIT_AREA);
    if (ANY_NODE(area))
        emission = WHERE_NODE(
            area, NODE_NAMED(node_area)(node, along, distance2, inverse, softened), emission);
#endif
    // Groups, and lights that their mean axis says all of.
    NODE_MASK cosines = NODE_HAS(node->kind, TRAIT_COSINE);
#if HAS_AREA
    cosines = cosines & !area;
#endif
    cosines = cosines | (node->kind == NODE_GROUP);
    if (ANY_NODE(cosines)) {
        const NODE_REAL o = 1.0f - node->iso, o2 = o * o;
        const NODE_REAL axis2 = node->ax * node->ax + node->ay * node->ay + node->az * node->az;
        const NODE_REAL delta = max(o2 - axis2, 1e-6f) / 3.0f;
        const REAL lobe = NAMED(soft)(along, *spread * o2 + delta);
        REAL mixed = node->iso + WHERE_NODE(node->iso < 1.0f, lobe, (REAL)(0.0f));
#if HAS_CONE
        // Nothing where none of a group's spots shines, but a little beside that.
        if (ANY_NODE(node->reach > -1.0f)) {
            const NODE_REAL reach_sine = sqrt(max(1.0f - node->reach * node->reach, 0.0f));
            const REAL sine = node->radius * inverse;
            const REAL cosine = NAMED(root)(max(1.0f - sine * sine, (REAL)(0.0f)));
            const REAL limit = (cosine * node->reach - sine * reach_sine) * sqrt(axis2);
            mixed *= WHERE((sine < 1.0f) & (cosine > -node->reach),
                           clamp(fma(REACH_EDGE, along - limit, (REAL)(1.0f)), 0.0f, 1.0f),
                           (REAL)(1.0f));
        }
#endif
        emission = WHERE_NODE(cosines, mixed, emission);
    }
    const REAL finite =
        WHERE(k + node->radius * inverse <= 0.0f, (REAL)(0.0f), incidence * emission);
#if HAS_INFINITE
    const NODE_MASK infinite =
        NODE_HAS(node->kind, TRAIT_INFINITE) | (node->kind == NODE_DIRECTIONS);
    if (ANY_NODE(infinite)) {  // the position is a direction
        const NODE_REAL length2 = node->x * node->x + node->y * node->y + node->z * node->z;
        const NODE_REAL scale = 1.0f / sqrt(max(length2, 1e-30f));
        *wx = WHERE_NODE(infinite, (REAL)(node->x * scale), *wx);
        *wy = WHERE_NODE(infinite, (REAL)(node->y * scale), *wy);
        *wz = WHERE_NODE(infinite, (REAL)(node->z * scale), *wz);
        *spread = WHERE_NODE(infinite, (REAL)(node->spread), *spread);
        const REAL facing = NAMED(dot3)(p->nx, p->ny, p->nz, *wx, *wy, *wz);
        const REAL all =
            WHERE(facing + node->radius <= 0.0f, (REAL)(0.0f), NAMED(soft)(facing, *spread));
        return WHERE_NODE(infinite, all, finite);
    }
#endif
    return finite;
}

// The node's radiance reflected to the camera, cd/m2: intensity x geometry x BRDF towards the
// centre.
INLINE NAMED(Color) NODE_NAMED(node_estimate)(const NODE* node, const NAMED(Points) * p) {
    REAL wx, wy, wz, spread;
    const REAL geometry = NODE_NAMED(node_geometry)(node, p, &wx, &wy, &wz, &spread);
    NAMED(Color) c = NAMED(reflect)(p, wx, wy, wz, spread, (REAL)(0.0f), geometry);
    c.red *= node->red;
    c.green *= node->green;
    c.blue *= node->blue;
    return c;
}

#undef WIDE_POINTS
#undef WIDE_NODES
#undef REAL
#undef NAMED
#undef WHERE
#undef NODE
#undef NODE_REAL
#undef NODE_MASK
#undef NODE_NAMED
#undef NODE_HAS
#undef ANY_NODE
#undef WHERE_NODE
