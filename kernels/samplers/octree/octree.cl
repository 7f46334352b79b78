// SPDX-License-Identifier: MIT
// Sampler octree: the nodes of the octree that are as good as one light for the pixel, and a shadow
// ray to each: to one of its lights, or to its virtual light.
#include "lib/random.h"
#include "lib/rays.h"
#include "lib/tiles.h"
#include "samplers/octree/bounds.h"

static bool is_leaf(__global const OctreeNode* nodes, uint node) {
    return nodes[node].next == node + 1u;
}

// What all lights contribute to the point without shadows, cd/m2, about: of nodes that it sees as
// small the virtual lights, and single lights.
static float3 estimate_total(__global const OctreeNode* octree, uint octree_size,
                             __global const Light* lights, const Receiver* r) {
    float3 total = (float3)(0.0f);
    for (uint i = 0u; i < octree_size;) {
        __global const OctreeNode* node = octree + i;
        if (is_leaf(octree, i)) {
            __global const Light* light = lights + node->light;
            Ray shadow;
            total += unshadowed(r, light, light_centroid(light), &shadow);
        } else {
            const float radius = node->centre.w;
            const float3 to_centre = node->centre.xyz - r->position;
            if (radius * radius >= OCTREE_SMALL * OCTREE_SMALL * dot(to_centre, to_centre)) {
                ++i;
                continue;
            }
            const Bounds b = bound_node(node, r);
            total += min(b.estimate, b.most) * node->intensity.xyz;
        }
        i = node->next;
    }
    return total;
}

// Whether the node's lights together contribute what the virtual light does, but for `error`,
// cd/m2; and so does any of them in place of all.
static bool is_alike(Bounds b, __global const OctreeNode* node, float3 error) {
    const float3 off = max(b.most - b.estimate, b.estimate - b.least);
    return all(off * node->intensity.xyz <= error);
}

// A leaf below the node, drawn by luminance of intensity; `weight` gets 1 / probability.
static uint draw_leaf(__global const OctreeNode* nodes, uint node, uint bits, float* weight) {
    *weight = 1.0f;
    for (uint step = 0u; !is_leaf(nodes, node); ++step) {
        const uint end = nodes[node].next;
        const float total = luminance(nodes[node].intensity.xyz);
        float left = unit_float(step_bits(bits, step)) * total;
        uint child = node + 1u;
        float own = luminance(nodes[child].intensity.xyz);
        while (left >= own && nodes[child].next < end) {
            left -= own;
            child = nodes[child].next;
            own = luminance(nodes[child].intensity.xyz);
        }
        *weight *= total / own;
        node = child;
    }
    return node;
}

// What the node's virtual light contributes, cd/m2, and its ray.
static float3 shade_virtual(__global const OctreeNode* node, const Receiver* r, float3 estimate,
                            Ray* shadow) {
    float3 target = node->centre.xyz;
    const float3 axis = node->axis.xyz;
    const float length2 = dot(axis, axis);
    if (length2 > 0.0f) {
        const bool behind = dot(axis, r->position - target) < 0.0f;
        target += axis * ((behind ? -node->intensity.w : node->intensity.w) / sqrt(length2));
    }
    shadow->origin = shadow_origin(r);
    shadow->direction = target - shadow->origin;
    shadow->end = 1.0f;
    return estimate * node->intensity.xyz;
}

// Goes on with the cut of each pixel from node next_nodes[item], 0 where `start`, until 16 rays are
// found or it ends, and keeps there where it is. totals[item] is what errors are relative to.
// Packet `item` of the rays, and values[48 * item + 16 * channel + lane], what each contributes
// where nothing is in its way, cd/m2. What is random about a node depends on its first light alone.
// `to_virtual`: rays go to virtual lights.
KERNEL void octree_draw(Tiles tiles, VIEW_PARAMETERS, __global const Surface* surfaces,
                        __global const Material* materials, __global const Light* lights,
                        __global const OctreeNode* octree, uint octree_size, float epsilon,
                        uint to_virtual, uint pixel_sample, uint seed, uint start,
                        __global uint* next_nodes, __global float4* totals,
                        __global float4* origins, __global float* rays, __global float* values) {
    const uint item = get_global_id(0);
    if (item >= tiles.count * tiles.size * tiles.size) return;
    uint lane = 0u;
    uint node = start ? 0u : next_nodes[item];
    if (!item_in_image(tiles, item) || surface_missed(surfaces + item)) node = octree_size;
    if (node < octree_size) {
        const Receiver receiver = make_receiver(surfaces, item, materials, VIEW);
        const uint2 pixel = item_pixel(tiles, item);
        __global float* value_lanes = values + 48 * (ulong)item;
        if (start && epsilon > 0.0f)
            totals[item].xyz = estimate_total(octree, octree_size, lights, &receiver);
        const float3 error = epsilon > 0.0f ? epsilon * totals[item].xyz : (float3)(-1.0f);
        while (node < octree_size && lane < 16u) {
            const bool leaf = is_leaf(octree, node);
            Bounds bounds;
            if (!leaf) {
                bounds = bound_node(octree + node, &receiver);
                const bool dark = all(bounds.most <= 0.0f);
                if (dark || !is_alike(bounds, octree + node, error)) {
                    node = dark ? octree[node].next : node + 1u;
                    continue;
                }
            }
            float3 value;
            Ray shadow;
            if (!leaf && to_virtual) {
                value = shade_virtual(octree + node, &receiver, bounds.estimate, &shadow);
            } else {
                const uint4 bits = random_bits(pixel.y * tiles.width + pixel.x, pixel_sample,
                                               octree[node].light, seed);
                float weight;
                const uint drawn = draw_leaf(octree, node, bits.x, &weight);
                const float2 u = (float2)(unit_float(bits.y), unit_float(bits.z));
                value = weight * unshadowed(&receiver, lights + octree[drawn].light, u, &shadow);
            }
            node = octree[node].next;
            if (!any(value != 0.0f)) continue;
            put_ray(rays, item, lane, shadow);
            value_lanes[lane] = value.x;
            value_lanes[lane + 16u] = value.y;
            value_lanes[lane + 32u] = value.z;
            if (lane == 0u) origins[item] = (float4)(shadow.origin, 0.0f);
            ++lane;
        }
    }
    next_nodes[item] = node;
    for (; lane < 16u; ++lane) RAY_END(rays, item, lane) = 0.0f;
}
