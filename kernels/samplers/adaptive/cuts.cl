// SPDX-License-Identifier: MIT
// Stage cuts: for each tile a cut through the light trees, fine where much light may come from, and
// a first look at what is visible.
#include "lib/direct.h"
#include "lib/random.h"
#include "lib/tiles.h"
#include "shared/adaptive.h"
#include "shared/light_tree.h"

#include "lib/node_estimate.h"

// A receiver as lib/node_estimate.h takes it.
static Points_1 point_of(const Receiver* r) {
    Points_1 p;
    p.px = r->position.x;
    p.py = r->position.y;
    p.pz = r->position.z;
    p.nx = r->normal.x;
    p.ny = r->normal.y;
    p.nz = r->normal.z;
    p.red = r->material.base_color.x;
    p.green = r->material.base_color.y;
    p.blue = r->material.base_color.z;
#if HAS_OUTGOING
    p.through_red = r->throughput.x;
    p.through_green = r->throughput.y;
    p.through_blue = r->throughput.z;
#endif
#if HAS_GGX
    p.vx = r->outgoing.x;
    p.vy = r->outgoing.y;
    p.vz = r->outgoing.z;
    p.metallic = r->material.base_color.w;
    p.alpha = r->material.roughness;
    p.specular = r->material.specular;
#if HAS_REFLECTANCE
    p.f0_red = r->material.reflectance.x;
    p.f0_green = r->material.reflectance.y;
    p.f0_blue = r->material.reflectance.z;
#endif
    p.glossy = p.metallic > 0.0f || p.specular > 0.0f;
#endif
    return p;
}

// The dimension of the random numbers of a tile's probes.
#define RANDOM_PROBES 0xfffffffeu

// A cut in work: a list in tree order.
typedef struct Cut {
    uint nodes[CUT_CAPACITY];
    float scores[CUT_CAPACITY];  // what makes splitting it worth while; 0 for leaves
    Trials trials[CUT_CAPACITY];
    uint next[CUT_CAPACITY];  // place in these arrays
    uint size;
} Cut;

// Up to REPRESENTATIVES items of a tile that hit the scene: the nine of a regular grid, or whatever
// there is.
static uint find_representatives(Tiles tiles, uint tile, __global const Surface* surfaces,
                                 uint* items) {
    uint count = 0u;
    const uint area = tiles.size * tiles.size;
    const uint2 corner =
        (uint2)((tiles.first + tile) % tiles.columns, (tiles.first + tile) / tiles.columns) *
        tiles.size;
    for (uint i = 0u; i < 9u; ++i) {
        const uint2 pixel =
            corner + (uint2)(2u * (i % 3u) + 1u, 2u * (i / 3u) + 1u) * tiles.size / 6u;
        const uint item = pixel_item(tiles, pixel.x, pixel.y);
        if (item_in_image(tiles, item) && !surface_missed(surfaces + item)) items[count++] = item;
    }
    for (uint i = 0u; i < area && count == 0u; ++i) {
        const uint item = tile * area + i;
        if (item_in_image(tiles, item) && !surface_missed(surfaces + item)) items[count++] = item;
    }
    return count;
}

// Traces `probes` rays from the representatives to lights of a node, each drawn by power.
static Trials probe(BVH_PARAMETERS, __global const LightNode* nodes, __global const Light* lights,
                    const Receiver* receivers, uint receiver_count, uint node, uint probes,
                    uint bits) {
    Trials trials = {0.0f, 0.0f};
    for (uint i = 0u; i < probes; ++i) {
        const uint ray_bits = step_bits(bits, i);
        float u = unit_float(ray_bits);
        uint at = node;
        while (nodes[at].count > 1u) {
            const uint right = at + 2u * nodes[at + 1u].count;
            const float a = nodes[at + 1u].cone.w;
            const float sum = a + nodes[right].cone.w;
            const float p = sum > 0.0f ? a / sum : 0.5f;
            const bool go_left = u < p;
            u = min(go_left ? u / p : (u - p) / (1.0f - p), 0x1.fffffep-1f);
            at = go_left ? at + 1u : right;
        }
        const uint r = (i + ray_bits % receiver_count) % receiver_count;
        const uint light = nodes[at].first;
        Ray shadow;
        const float3 value =
            unshadowed(receivers + r, lights + light, light_centroid(lights + light), &shadow);
        if (!any(value != 0.0f)) continue;
        trials.traced += 1.0f;
        if (!occluded(BVH_ARGUMENTS, shadow)) trials.passed += 1.0f;
    }
    return trials;
}

static float visible_root(Trials t) { return sqrt((t.passed + PRIOR_SHARE) / (t.traced + 1.0f)); }

// The place of the node to split, of the largest score: of those that something is seen of, once
// half of the cut are others; NO_ITEM: none can be split.
static uint next_split(const Cut* cut, uint cut_size) {
    uint seen = NO_ITEM, hidden = NO_ITEM;
    uint hidden_count = 0u;
    float seen_score = 0.0f, hidden_score = 0.0f;
    for (uint i = 0u; i < cut->size; ++i) {
        const bool is_hidden = cut->trials[i].passed < SEEN_RAYS;
        hidden_count += is_hidden ? 1u : 0u;
        if (is_hidden && cut->scores[i] > hidden_score) {
            hidden = i;
            hidden_score = cut->scores[i];
        } else if (!is_hidden && cut->scores[i] > seen_score) {
            seen = i;
            seen_score = cut->scores[i];
        }
    }
    if (seen == NO_ITEM) return hidden;
    return hidden_score > seen_score && 2u * hidden_count < cut_size ? hidden : seen;
}

// cut_nodes[tile * CUT_CAPACITY + slot], in tree order, and probes[...]; cut_sizes[tile]. With up
// to cut_size lights, every light is a node. Where nothing is hit, the roots are the cut: later
// pixel samples may hit something.
KERNEL void cuts_make(Tiles tiles, VIEW_PARAMETERS, __global const Surface* surfaces,
                      __global const Material* materials, __global const Light* lights,
                      uint light_count, __global const LightNode* nodes, uint root_count,
                      uint second_root, uint cut_size, uint probe_rays, uint seed, BVH_PARAMETERS,
                      __global uint* cut_nodes, __global uint* cut_sizes, __global Trials* probes) {
    const uint tile = get_global_id(0);
    if (tile >= tiles.count) return;
    uint items[REPRESENTATIVES];
    const uint receiver_count = find_representatives(tiles, tile, surfaces, items);
    __global uint* out = cut_nodes + tile * CUT_CAPACITY;
    __global Trials* out_trials = probes + tile * CUT_CAPACITY;
    const Trials none = {0.0f, 0.0f};
    if (receiver_count == 0u) {
        for (uint i = 0u; i < root_count; ++i) {
            out[i] = i == 0u ? 0u : second_root;
            out_trials[i] = none;
        }
        cut_sizes[tile] = root_count;
        return;
    }
    Receiver receivers[REPRESENTATIVES];
    for (uint i = 0u; i < receiver_count; ++i)
        receivers[i] = make_receiver(surfaces, items[i], materials, VIEW);
    const uint tile_bits = random_bits(tiles.first + tile, 0u, RANDOM_PROBES, seed).x;
    if (light_count <= cut_size) {
        const uint node_count = 2u * light_count - root_count;
        uint size = 0u;
        for (uint node = 0u; node < node_count; ++node) {
            if (nodes[node].count > 1u) continue;
            out_trials[size] = probe(BVH_ARGUMENTS, nodes, lights, receivers, receiver_count, node,
                                     probe_rays, step_bits(tile_bits, node));
            out[size++] = node;
        }
        cut_sizes[tile] = size;
        return;
    }
    Cut cut;
    cut.size = root_count;
    for (uint i = 0u; i < root_count; ++i) {
        cut.nodes[i] = i == 0u ? 0u : second_root;
        cut.scores[i] = nodes[cut.nodes[i]].count > 1u ? INFINITY : 0.0f;
        cut.trials[i] = none;
        cut.next[i] = i + 1u;
    }
    while (cut.size < cut_size) {
        const uint worst = next_split(&cut, cut_size);
        if (worst == NO_ITEM) break;
        const uint node = cut.nodes[worst];
        const Trials parent = cut.trials[worst];
        const uint added = cut.size++;
        cut.next[added] = cut.next[worst];
        cut.next[worst] = added;
        for (uint side = 0u; side < 2u; ++side) {
            const uint place = side == 0u ? worst : added;
            const uint at = side == 0u ? node + 1u : node + 2u * nodes[node + 1u].count;
            Trials trials = probe(BVH_ARGUMENTS, nodes, lights, receivers, receiver_count, at,
                                  probe_rays, step_bits(tile_bits, at));
            trials.traced += INHERITED * parent.traced;
            trials.passed += INHERITED * parent.passed;
            float score = 0.0f;
            if (nodes[at].count > 1u) {
                const Node_1 child = load_node(nodes + at, lights);
                for (uint i = 0u; i < receiver_count; ++i) {
                    const Points_1 point = point_of(receivers + i);
                    score += color_luminance_1(node_estimate_1(&child, &point));
                }
                score *= visible_root(trials);
            }
            cut.nodes[place] = at;
            cut.scores[place] = score;
            cut.trials[place] = trials;
        }
    }
    uint place = 0u;
    for (uint i = 0u; i < cut.size; ++i) {
        out[i] = cut.nodes[place];
        out_trials[i] = cut.trials[place];
        place = cut.next[place];
    }
    cut_sizes[tile] = cut.size;
}
