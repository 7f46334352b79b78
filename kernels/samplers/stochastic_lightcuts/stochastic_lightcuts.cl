// SPDX-License-Identifier: MIT
// Sampler stochastic-lightcuts: at each pixel a cut of the light tree by bounds, and one light of
// each of its nodes, drawn on a way down (Yuksel, "Stochastic Lightcuts", 2019; Lin and Yuksel,
// "Real-Time Stochastic Lightcuts", 2020).
#include "lib/draw.h"
#include "lib/light_tree.h"
#include "lib/random.h"
#include "shared/stochastic_lightcuts.h"

// A round of light samples: MOST_CUT_NODES of them, or what is left.
static uint round_first(uint sample) { return sample / MOST_CUT_NODES * MOST_CUT_NODES; }

static uint round_size(Draw draw) {
    return min(draw.sample_count - round_first(draw.sample), (uint)MOST_CUT_NODES);
}

// Nodes in the tree's order, which together hold every light that may shine on the pixel.
typedef struct Cut {
    uint count;
    uint nodes[MOST_CUT_NODES];
    float bounds[MOST_CUT_NODES];  // 0: a light
} Cut;

#define PIXEL_STATE Cut
#define SAMPLER_PARAMETERS \
    , __global const LightNode *nodes, uint root_count, uint second_root, uint cut_nodes
#define SAMPLER_ARGUMENTS , nodes, root_count, second_root, cut_nodes
#define CLOSED_FORM
#define SAMPLE_ROUND MOST_CUT_NODES

static bool is_leaf(__global const LightNode* nodes, uint node) {
    return node != BOTH_ROOTS && nodes[node].count == 1u;
}

static uint left_child(uint node) { return node == BOTH_ROOTS ? 0u : node + 1u; }

static uint right_child(__global const LightNode* nodes, uint node, uint second_root) {
    return node == BOTH_ROOTS ? second_root : node + 2u * nodes[node + 1u].count;
}

// What a node's lights shine at most where nothing else is known than cosines: luminance of the
// intensity x cosines, cd; of directional lights lx.
static float node_reach(__global const LightNode* node, NodeView view) {
    return luminance(node->intensity.xyz) * view.cosines;
}

// Squared distances to the bounds' nearest and farthest points.
static float nearest2(__global const LightNode* node, float3 p) {
    const float3 apart = max(max(node->lower.xyz - p, p - node->upper.xyz), (float3)(0.0f));
    return dot(apart, apart);
}

static float farthest2(__global const LightNode* node, float3 p) {
    const float3 apart = max(fabs(node->lower.xyz - p), fabs(node->upper.xyz - p));
    return dot(apart, apart);
}

// An upper bound, but for the material, of the illuminance by a node's lights, lx. Distances count
// as the radius of the bounds at least, so it is none where the point is as close as that.
static float node_bound(__global const LightNode* node, const Receiver* r) {
    const NodeView view = view_node(node, r);
    const float reach = node_reach(node, view);
    if (NODE_IS_INFINITE(*node)) return reach;
    const float floor2 = max(nearest2(node, r->position), view.radius2);
    return floor2 > 0.0f ? min(reach / floor2, 1e37f) : 0.0f;
}

// Puts a node in place `at` of a cut.
static void set_node(Cut* cut, uint at, uint node, float bound, bool leaf) {
    cut->nodes[at] = node;
    cut->bounds[at] = leaf ? 0.0f : bound;
}

// Makes room at a place of a cut, or closes it.
static void open_place(Cut* cut, uint at) {
    for (uint i = cut->count++; i > at; --i) {
        cut->nodes[i] = cut->nodes[i - 1u];
        cut->bounds[i] = cut->bounds[i - 1u];
    }
}

static void close_place(Cut* cut, uint at) {
    --cut->count;
    for (uint i = at; i < cut->count; ++i) {
        cut->nodes[i] = cut->nodes[i + 1u];
        cut->bounds[i] = cut->bounds[i + 1u];
    }
}

static uint largest_bound(const Cut* cut) {
    uint largest = 0u;
    for (uint i = 1u; i < cut->count; ++i)
        if (cut->bounds[i] > cut->bounds[largest]) largest = i;
    return largest;
}

// From the root on, the node with the largest bound is replaced by its children, as long as there
// is room for one more. Nodes none of whose lights shines on the pixel are left out.
static void begin_pixel(const Receiver* receiver, __global const Light* lights, Draw first,
                        __global const LightNode* nodes, uint root_count, uint second_root,
                        uint cut_nodes, Cut* cut) {
    const uint size = min(round_size(first), cut_nodes);
    const uint root = root_count > 1u ? BOTH_ROOTS : 0u;
    cut->count = 1u;
    set_node(cut, 0u, root, INFINITY, is_leaf(nodes, root));
    while (cut->count > 0u && cut->count < size) {
        const uint at = largest_bound(cut);
        if (cut->bounds[at] == 0.0f) return;
        const uint left = left_child(cut->nodes[at]);
        const uint right = right_child(nodes, cut->nodes[at], second_root);
        const float left_bound = node_bound(nodes + left, receiver);
        const float right_bound = node_bound(nodes + right, receiver);
        if (left_bound > 0.0f && right_bound > 0.0f) open_place(cut, at + 1u);
        if (left_bound > 0.0f) set_node(cut, at, left, left_bound, is_leaf(nodes, left));
        if (right_bound > 0.0f)
            set_node(cut, left_bound > 0.0f ? at + 1u : at, right, right_bound,
                     is_leaf(nodes, right));
        if (left_bound == 0.0f && right_bound == 0.0f) close_place(cut, at);
    }
}

// a and b of their sum; `otherwise` where that is out of range.
static float2 parts_of(float a, float b, float2 otherwise) {
    const float sum = a + b;
    return sum > 0.0f && sum < INFINITY ? (float2)(a, b) / sum : otherwise;
}

// The probabilities of two sibling nodes, both 0 where none of their lights shines on the point:
// the mean of what is proportional to reach / squared distance to the nearest and to the farthest
// point of the bounds. Within either's bounds the nearest does not count.
static float2 child_probabilities(__global const LightNode* a, __global const LightNode* b,
                                  const Receiver* r) {
    const float reach_a = node_reach(a, view_node(a, r));
    const float reach_b = node_reach(b, view_node(b, r));
    const float2 by_reach = parts_of(reach_a, reach_b, (float2)(0.0f));
    if (NODE_IS_INFINITE(*a)) return by_reach;
    const float near_a = nearest2(a, r->position);
    const float near_b = nearest2(b, r->position);
    const float2 by_nearest = near_a > 0.0f && near_b > 0.0f
                                  ? parts_of(reach_a * near_b, reach_b * near_a, by_reach)
                                  : by_reach;
    const float far_a = farthest2(a, r->position);
    const float far_b = farthest2(b, r->position);
    return 0.5f * (by_nearest + parts_of(reach_a * far_b, reach_b * far_a, by_reach));
}

// The same of the two roots, by their bounds: one has no distance.
static float2 root_probabilities(__global const LightNode* nodes, uint second_root,
                                 const Receiver* r) {
    return parts_of(node_bound(nodes, r), node_bound(nodes + second_root, r), (float2)(0.0f));
}

static float2 probabilities_below(__global const LightNode* nodes, uint node, uint second_root,
                                  const Receiver* r) {
    if (node == BOTH_ROOTS) return root_probabilities(nodes, second_root, r);
    return child_probabilities(nodes + left_child(node),
                               nodes + right_child(nodes, node, second_root), r);
}

// Draw i of n from a node.
static Choice descend(const Receiver* receiver, __global const LightNode* nodes, uint second_root,
                      uint node, uint i, uint n, uint4 bits) {
    const Choice none = {0u, 0.0f};
    float u = ((float)i + unit_float(bits.x)) / (float)n;
    float probability = 1.0f;
    for (uint step = 0u; !is_leaf(nodes, node); ++step) {
        const uint left = left_child(node);
        const uint right = right_child(nodes, node, second_root);
        const float2 p = probabilities_below(nodes, node, second_root, receiver);
        if (!(p.x + p.y > 0.0f)) return none;
        // Where less than one sample is expected strata have no use any more: fresh digits.
        if (probability * (float)n < 1.0f) u = unit_float(step_bits(bits.w, step));
        const bool go_left = u < p.x;
        const float taken = go_left ? p.x : p.y;
        u = min((go_left ? u : u - p.x) / taken, 0x1.fffffep-1f);
        probability *= taken;
        node = go_left ? left : right;
    }
    const Choice choice = {nodes[node].first, 1.0f / (probability * (float)n)};
    return choice;
}

// A round's samples go to the nodes in order, to each as many as to another, or one more: the first
// of those of a place.
static uint first_of_place(const Cut* cut, uint at, uint size) {
    return (at * size + cut->count - 1u) / cut->count;
}

static Choice choose_light(const Receiver* receiver, __global const Light* lights, Draw draw,
                           __global const LightNode* nodes, uint root_count, uint second_root,
                           uint cut_nodes, const Cut* cut) {
    Choice choice = {0u, 0.0f};
    if (cut->count == 0u) return choice;
    const uint size = round_size(draw);
    const uint sample = draw.sample - round_first(draw.sample);
    const uint at = sample * cut->count / size;
    const uint begin = first_of_place(cut, at, size);
    choice = descend(receiver, nodes, second_root, cut->nodes[at], sample - begin,
                     first_of_place(cut, at + 1u, size) - begin, draw.bits);
    choice.weight *= (float)size / (float)draw.sample_count;
    return choice;
}

static bool holds(__global const LightNode* nodes, uint node, uint light) {
    return node == BOTH_ROOTS ||
           (light >= nodes[node].first && light < nodes[node].first + nodes[node].count);
}

// That of its node's draws on the way down to the light, by the node's part of the round's.
static float light_probability(const Receiver* receiver, __global const Light* lights, Draw draw,
                               uint light, __global const LightNode* nodes, uint root_count,
                               uint second_root, uint cut_nodes, const Cut* cut) {
    uint at = 0u;
    while (at < cut->count && !holds(nodes, cut->nodes[at], light)) ++at;
    if (at == cut->count) return 0.0f;
    float probability = 1.0f;
    for (uint node = cut->nodes[at]; !is_leaf(nodes, node);) {
        const uint right = right_child(nodes, node, second_root);
        const float2 p = probabilities_below(nodes, node, second_root, receiver);
        const bool go_left = light < nodes[right].first;
        probability *= go_left ? p.x : p.y;
        node = go_left ? left_child(node) : right;
    }
    const uint size = round_size(draw);
    const uint draws = first_of_place(cut, at + 1u, size) - first_of_place(cut, at, size);
    return probability * (float)draws / (float)size;
}

#include "lib/samples.h"

#include "lib/reflected.h"
