// SPDX-License-Identifier: MIT
#include "reference/cuts.hpp"

#include <algorithm>
#include <cmath>
#include <list>

#include "reference/contributions.hpp"
#include "reference/random.hpp"
#include "reference/tiles.hpp"
#include "shared/adaptive.h"

namespace manylight::reference {
namespace {

// Surface points of a tile that stand for it: 9 spread over it or, where none of those is one, the
// first along the Morton curve. Empty where no pixel hits anything.
std::vector<const Surface*> find_representatives(const Tiles& tiles, uint tile,
                                                 std::span<const Surface> surfaces) {
    std::vector<const Surface*> found;
    const uint x0 = (tiles.first + tile) % tiles.columns * tiles.size;
    const uint y0 = (tiles.first + tile) / tiles.columns * tiles.size;
    const auto consider = [&](uint x, uint y) {
        if (x >= tiles.width || y >= tiles.height) return;
        const Surface& s = surfaces[item_of(tiles, x, y)];
        if (s.position.w >= 0) found.push_back(&s);
    };
    for (uint i = 0; i < 9; ++i)
        consider(x0 + (2 * (i % 3) + 1) * tiles.size / 6, y0 + (2 * (i / 3) + 1) * tiles.size / 6);
    if (!found.empty()) return found;
    const std::size_t area = std::size_t{tiles.size} * tiles.size;
    std::size_t best = area;
    for (uint y = y0; y < std::min(y0 + tiles.size, tiles.height); ++y)
        for (uint x = x0; x < std::min(x0 + tiles.size, tiles.width); ++x)
            if (surfaces[item_of(tiles, x, y)].position.w >= 0)
                best = std::min(best, item_of(tiles, x, y) % area);
    if (best < area) found.push_back(&surfaces[tile * area + best]);
    return found;
}

// What a tile's cut is made by.
struct Prober {
    const LightTree& tree;
    const Scene& scene;
    const Tracer& tracer;
    const Viewers& view;
    std::span<const Surface> surfaces;
    std::vector<const Surface*> representatives;
    uint rays;       // of a node
    uint tile_bits;  // random
    bool uncertain = false;

    [[nodiscard]] Viewer viewer(const Surface& surface) const {
        return view.of(static_cast<std::size_t>(&surface - surfaces.data()));
    }

    // A leaf below a node, by the power of children.
    uint choose_leaf(uint node, double u) {
        double blur = 1e-6;
        while (tree.nodes[node].count > 1) {
            const uint right = right_child(tree, node);
            const double a = tree.nodes[node + 1].cone.w;
            const double sum = a + double{tree.nodes[right].cone.w};
            const double p = sum > 0 ? a / sum : 0.5;
            if (std::abs(u - p) < blur) uncertain = true;
            const bool left = u < p;
            blur = (blur + 1e-6) / (left ? p : 1 - p);
            u = left ? u / p : (u - p) / (1 - p);
            node = left ? node + 1 : right;
        }
        return node;
    }

    Rays probe(uint node) {
        Rays found;
        for (uint i = 0; i < rays; ++i) {
            const uint bits = step_bits(step_bits(tile_bits, node), i);
            const uint leaf = choose_leaf(node, unit_fraction(bits));
            const auto count = static_cast<uint>(representatives.size());
            const Surface& s = *representatives[(i + bits % count) % count];
            const Light& light = tree.lights[tree.nodes[leaf].first];
            const Unshadowed term =
                unshadowed(s, scene.materials[s.shading], viewer(s), light, centroid(light));
            // Whether there is light at all: a light with area is hardly seen in its own plane.
            if (glm::length(term.value) <=
                rounding_slack(s, scene.materials[s.shading], viewer(s), light, centroid(light)))
                uncertain = uncertain || has_area(light);
            if (term.value == glm::dvec3(0)) continue;
            found.traced += 1;
            found.passed += tracer.occluded(term.shadow) ? 0 : 1;
            if (tracer.occlusion_is_borderline(term.shadow, term.rounding)) uncertain = true;
        }
        return found;
    }

    // How much light the node's estimates promise, by what its probes saw.
    [[nodiscard]] double score(uint node, const Rays& seen) const {
        double sum = 0;
        for (const Surface* s : representatives)
            sum += luminance(node_estimate(tree, node, {scene, viewer(*s), *s}));
        return sum * std::sqrt((seen.passed + double{PRIOR_SHARE}) / (seen.traced + 1));
    }
};

struct Entry {
    uint node;
    double score;
    Rays rays;
};

bool is_hidden(const Entry& e) { return e.rays.passed < double{SEEN_RAYS}; }

std::size_t hidden_count(const std::list<Entry>& cut) {
    return static_cast<std::size_t>(std::ranges::count_if(cut, is_hidden));
}

// The node that promises most: of those that something is seen of, once half of the cut are others.
std::list<Entry>::iterator next_split(std::list<Entry>& cut, uint cut_size) {
    const auto best = [&](bool hidden) {
        auto found = cut.end();
        for (auto i = cut.begin(); i != cut.end(); ++i)
            if (is_hidden(*i) == hidden && i->score > (found == cut.end() ? 0 : found->score))
                found = i;
        return found;
    };
    const auto seen = best(false);
    const auto hidden = best(true);
    if (seen == cut.end()) return hidden;
    if (hidden == cut.end() || 2 * hidden_count(cut) >= cut_size) return seen;
    return hidden->score > seen->score ? hidden : seen;
}

// The roots, of which the node that promises most is split again and again.
std::list<Entry> split_nodes(Prober& prober, uint cut_size) {
    const LightTree& tree = prober.tree;
    std::list<Entry> cut;
    for (const uint root : tree.roots)
        cut.push_back({root, tree.nodes[root].count > 1 ? 1e300 : 0.0, {}});
    while (cut.size() < cut_size) {
        const auto best = next_split(cut, cut_size);
        if (best == cut.end()) break;
        // Who is split last is a close call where scores are equal.
        if (cut.size() + 1 == cut_size || 2 * (hidden_count(cut) + 1) >= cut_size)
            for (auto i = cut.begin(); i != cut.end(); ++i)
                if (i != best && i->score > best->score * (1 - doubtful)) prober.uncertain = true;
        const Entry parent = *best;
        for (const uint at : {parent.node + 1, right_child(tree, parent.node)}) {
            Entry child{at, 0, prober.probe(at)};
            child.rays.traced += INHERITED * parent.rays.traced;
            child.rays.passed += INHERITED * parent.rays.passed;
            if (tree.nodes[at].count > 1) child.score = prober.score(at, child.rays);
            cut.insert(best, child);
        }
        cut.erase(best);
    }
    return cut;
}

}  // namespace

TileCut make_cut(const LightTree& tree, const Scene& scene, const Tracer& tracer,
                 const Viewers& view, const Tiles& tiles, uint tile,
                 std::span<const Surface> surfaces, uint cut_size, uint probe_rays, uint seed) {
    Prober prober{tree,       scene,
                  tracer,     view,
                  surfaces,   find_representatives(tiles, tile, surfaces),
                  probe_rays, random_bits(tiles.first + tile, 0, 0xfffffffeu, seed)[0]};
    TileCut out;
    if (prober.representatives.empty()) {
        out.nodes = tree.roots;
        out.probes.resize(tree.roots.size());
        return out;
    }
    const auto add = [&](uint node, const Rays& rays) {
        out.nodes.push_back(node);
        out.probes.push_back(rays);
    };
    if (tree.lights.size() <= cut_size) {
        for (uint node = 0; node < tree.nodes.size(); ++node)
            if (tree.nodes[node].count == 1) add(node, prober.probe(node));
    } else {
        for (const Entry& e : split_nodes(prober, cut_size)) add(e.node, e.rays);
    }
    out.uncertain = prober.uncertain;
    return out;
}

}  // namespace manylight::reference
