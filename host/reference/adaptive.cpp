// SPDX-License-Identifier: MIT
#include "reference/adaptive.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <list>

#include "reference/contributions.hpp"
#include "reference/random.hpp"
#include "reference/tiles.hpp"

namespace manylight::reference {
namespace {

constexpr double doubtful = 1e-4;  // difference in a decision that single precision may not see

// max(k, 0) smoothed over sqrt(v).
double soft(double k, double v) {
    const double root = std::sqrt(k * k + v);
    return k >= 0 ? (k + root) / 2 : (v == 0 ? 0 : v / (2 * (root - k)));
}

// glTF's BRDF with a lobe of squared width a2, for a direction that may be below the surface.
glm::dvec3 widened_brdf(const Material& m, const glm::dvec3& n, const glm::dvec3& wi,
                        const glm::dvec3& wo, double spread) {
    const glm::dvec3 base(m.base_color);
    if (m.base_color.w == 0 && m.specular == 0) return base / glm::pi<double>();
    const glm::dvec3 sum = wi + wo;
    if (glm::dot(sum, sum) < 1e-20) return glm::dvec3(0);  // from behind
    const glm::dvec3 h = glm::normalize(sum);
    const double a2 = double{m.roughness} * m.roughness + spread / 4;
    const double n_h = glm::dot(n, h);
    const double n_l = std::max(glm::dot(n, wi), 0.0);
    const double n_v = std::max(std::abs(glm::dot(n, wo)), 1e-4);
    const double d = std::min(n_h * n_h, 1.0) * (a2 - 1) + 1;
    const auto smith = [a2](double c) { return c + std::sqrt(a2 + (1 - a2) * c * c); };
    const double lobe = a2 / (glm::pi<double>() * d * d * smith(n_l) * smith(n_v));
    const double schlick = std::pow(std::max(1 - std::abs(glm::dot(wo, h)), 0.0), 5);
    const glm::dvec3 f0(m.reflectance);
    const glm::dvec3 fresnel = double{m.specular} * (f0 + (1.0 - f0) * schlick);
    const double most = std::max({fresnel.r, fresnel.g, fresnel.b});
    const glm::dvec3 dielectric = (1 - most) * base / glm::pi<double>() + lobe * fresnel;
    const glm::dvec3 metal = lobe * (base + (1.0 - base) * schlick);
    return glm::mix(dielectric, metal, double{m.base_color.w});
}

uint right_child(const LightTree& tree, uint node) { return node + 2 * tree.nodes[node + 1].count; }

bool single_point(const LightNode& node) {
    return node.kind != NODE_GROUP && node.kind != LIGHT_TRIANGLE && node.kind != LIGHT_QUAD;
}

// Falloff and cone of a leaf, relative to what an isotropic point would give.
double leaf_emission(const LightNode& node, const Light& light, const glm::dvec3& d,
                     const glm::dvec3& towards) {
    const double distance = glm::length(d);
    double emission = 1;
    if (light.axis.w > 0) emission = std::clamp(1 - std::pow(distance / light.axis.w, 4), 0.0, 1.0);
    if (node.kind == LIGHT_SPOT) {
        const double versine = 1 - glm::dot(-towards, glm::normalize(glm::dvec3(light.axis)));
        emission *= std::pow(std::clamp((light.edge.y - versine) * light.edge.x, 0.0, 1.0), 2);
    }
    return emission;
}

// 0 where none of a group's lights shines: off its mean axis by more than its reach and what its
// radius is seen under.
double share_in_reach(const LightNode& node, const glm::dvec3& towards, double distance) {
    const double seen = node.intensity.w / distance;
    if (node.reach <= -1 || seen >= 1) return 1;
    const double angle = std::acos(double{node.reach}) + std::asin(seen);
    if (angle >= glm::pi<double>()) return 1;
    const glm::dvec3 axis(node.axis);
    const double inside = -glm::dot(axis, towards) - std::cos(angle) * glm::length(axis);
    return std::clamp(1 + 20 * inside, 0.0, 1.0);
}

}  // namespace

glm::dvec3 node_estimate(const LightTree& tree, uint index, const Point& point) {
    const LightNode& node = tree.nodes[index];
    const Surface& s = point.surface;
    const glm::dvec3 normal(s.normal);
    const glm::dvec3 centre(node.centre);
    glm::dvec3 towards;
    double spread;
    double factor;
    if (NODE_IS_INFINITE(node)) {
        towards = glm::normalize(centre);
        spread = node.centre.w;
        const double k = glm::dot(normal, towards);
        if (k + node.intensity.w <= 0) return glm::dvec3(0);
        factor = soft(k, spread);
    } else {
        const glm::dvec3 d = centre - glm::dvec3(s.position);
        const double distance = glm::length(d);
        if (distance == 0) return glm::dvec3(0);
        towards = d / distance;
        const double softened = distance * distance + node.centre.w;
        spread = node.centre.w / softened;
        const double k = glm::dot(normal, towards);
        if (k + node.intensity.w / distance <= 0) return glm::dvec3(0);
        double emission;
        const Light& light = tree.lights[node.first];
        const glm::dvec3 axis(node.axis);
        if (node.kind == LIGHT_POINT || node.kind == LIGHT_SPOT) {
            emission = leaf_emission(node, light, d, towards);
        } else if (node.kind == LIGHT_TRIANGLE || node.kind == LIGHT_QUAD) {
            const glm::dvec3 n =
                glm::normalize(glm::cross(glm::dvec3(light.axis), glm::dvec3(light.edge)));
            const double height = -glm::dot(d, n);
            emission = (light.axis.w != 0 ? std::abs(height) : std::max(height, 0.0)) /
                       std::sqrt(softened);
        } else {
            const double oriented = 1 - double{node.axis.w};
            const double delta = std::max(oriented * oriented - glm::dot(axis, axis), 1e-6) / 3;
            emission = node.axis.w;
            if (oriented > 0)
                emission += soft(-glm::dot(axis, towards), spread * oriented * oriented + delta);
            emission *= share_in_reach(node, towards, distance);
        }
        factor = soft(k, spread) * emission / softened;
    }
    const glm::dvec3 to_camera = direction_to_camera(point.camera, glm::dvec3(s.position));
    return glm::dvec3(node.intensity) * factor *
           widened_brdf(point.material(), normal, towards, to_camera, spread);
}

TileCut make_cut(const LightTree& tree, const Scene& scene, const Tracer& tracer,
                 const Camera& camera, const Tiles& tiles, uint tile,
                 std::span<const Surface> surfaces, uint cut_size, uint probe_rays, uint seed) {
    std::vector<const Surface*> representatives;
    const uint x0 = (tiles.first + tile) % tiles.columns * tiles.size;
    const uint y0 = (tiles.first + tile) / tiles.columns * tiles.size;
    const auto consider = [&](uint x, uint y) {
        if (x >= tiles.width || y >= tiles.height) return;
        const Surface& s = surfaces[item_of(tiles, x, y)];
        if (s.position.w >= 0) representatives.push_back(&s);
    };
    for (uint i = 0; i < 9; ++i)
        consider(x0 + (2 * (i % 3) + 1) * tiles.size / 6, y0 + (2 * (i / 3) + 1) * tiles.size / 6);
    TileCut out;
    if (representatives.empty()) {  // the first along the Morton curve
        const std::size_t area = std::size_t{tiles.size} * tiles.size;
        std::size_t best = area;
        for (uint y = y0; y < std::min(y0 + tiles.size, tiles.height); ++y)
            for (uint x = x0; x < std::min(x0 + tiles.size, tiles.width); ++x)
                if (surfaces[item_of(tiles, x, y)].position.w >= 0)
                    best = std::min(best, item_of(tiles, x, y) % area);
        if (best == area) {
            out.nodes = tree.roots;
            out.probes.resize(tree.roots.size());
            return out;
        }
        representatives.push_back(&surfaces[tile * area + best]);
    }
    const uint tile_bits = random_bits(tiles.first + tile, 0, 0xfffffffeu, seed)[0];
    const auto probe = [&](uint node) {
        Rays rays;
        for (uint i = 0; i < probe_rays; ++i) {
            const uint bits = step_bits(step_bits(tile_bits, node), i);
            double u = unit_fraction(bits);
            uint at = node;
            double blur = 1e-6;
            while (tree.nodes[at].count > 1) {
                const uint right = right_child(tree, at);
                const double a = tree.nodes[at + 1].cone.w;
                const double sum = a + double{tree.nodes[right].cone.w};
                const double p = sum > 0 ? a / sum : 0.5;
                if (std::abs(u - p) < blur) out.uncertain = true;
                const bool left = u < p;
                blur = (blur + 1e-6) / (left ? p : 1 - p);
                u = left ? u / p : (u - p) / (1 - p);
                at = left ? at + 1 : right;
            }
            const auto count = static_cast<uint>(representatives.size());
            const Surface& s = *representatives[(i + bits % count) % count];
            const Light& light = tree.lights[tree.nodes[at].first];
            const Unshadowed term =
                unshadowed(s, scene.materials[s.shading], camera, light, centroid(light));
            // Whether there is light at all: a light with area is hardly seen in its own plane.
            if (glm::length(term.value) <=
                rounding_slack(s, scene.materials[s.shading], camera, light, centroid(light)))
                out.uncertain = out.uncertain || has_area(light);
            if (term.value == glm::dvec3(0)) continue;
            rays.traced += 1;
            rays.passed += tracer.occluded(term.shadow) ? 0 : 1;
            if (tracer.occlusion_is_borderline(term.shadow, term.rounding)) out.uncertain = true;
        }
        return rays;
    };
    if (tree.lights.size() <= cut_size) {
        for (uint node = 0; node < tree.nodes.size(); ++node) {
            if (tree.nodes[node].count > 1) continue;
            out.nodes.push_back(node);
            out.probes.push_back(probe(node));
        }
        return out;
    }
    struct Entry {
        uint node;
        double score;
        Rays rays;
    };
    std::list<Entry> cut;
    for (const uint root : tree.roots)
        cut.push_back({root, tree.nodes[root].count > 1 ? 1e300 : 0.0, {}});
    while (cut.size() < cut_size) {
        auto best = cut.begin();
        for (auto i = cut.begin(); i != cut.end(); ++i)
            if (i->score > best->score) best = i;
        if (best->score <= 0) break;
        // Who is split last is a close call where scores are equal.
        if (cut.size() + 1 == cut_size)
            for (auto i = cut.begin(); i != cut.end(); ++i)
                if (i != best && i->score > best->score * (1 - doubtful)) out.uncertain = true;
        const Entry parent = *best;
        for (const uint at : {parent.node + 1, right_child(tree, parent.node)}) {
            Entry child{at, 0, probe(at)};
            child.rays.traced += parent.rays.traced / 2;
            child.rays.passed += parent.rays.passed / 2;
            if (tree.nodes[at].count > 1) {
                for (const Surface* s : representatives)
                    child.score += luminance(node_estimate(tree, at, {scene, camera, *s}));
                child.score *= std::sqrt((child.rays.passed + 0.7) / (child.rays.traced + 1));
            }
            cut.insert(best, child);
        }
        cut.erase(best);
    }
    for (const Entry& e : cut) {
        out.nodes.push_back(e.node);
        out.probes.push_back(e.rays);
    }
    return out;
}

std::vector<Rays> share_rays(const LightTree& tree, const Tiles& tiles, uint tile,
                             std::span<const TileRays> all) {
    std::vector<Rays> out = all[tile].totals;
    const int x = static_cast<int>((tiles.first + tile) % tiles.columns);
    const int y = static_cast<int>((tiles.first + tile) / tiles.columns);
    for (std::size_t slot = 0; slot < out.size(); ++slot) {
        const LightNode& node = tree.nodes[all[tile].nodes[slot]];
        Rays lent;
        for (const glm::ivec2 step : {glm::ivec2(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
            if (x + step.x < 0 || x + step.x >= static_cast<int>(tiles.columns)) continue;
            const int other = (y + step.y) * static_cast<int>(tiles.columns) + x + step.x -
                              static_cast<int>(tiles.first);
            if (other < 0 || other >= static_cast<int>(all.size())) continue;
            for (std::size_t i = 0; i < all[other].nodes.size(); ++i) {
                const LightNode& theirs = tree.nodes[all[other].nodes[i]];
                const int common = static_cast<int>(std::min(node.first + node.count,
                                                             theirs.first + theirs.count)) -
                                   static_cast<int>(std::max(node.first, theirs.first));
                if (common <= 0) continue;
                const double share = static_cast<double>(common) / theirs.count;
                lent.traced += share * all[other].totals[i].traced;
                lent.passed += share * all[other].totals[i].passed;
            }
        }
        const double scale = lent.traced > 16 ? 16 / lent.traced : 1;
        out[slot].traced += scale * lent.traced;
        out[slot].passed += scale * lent.passed;
    }
    return out;
}

std::vector<double> estimate_visibility(std::span<const Rays> totals,
                                        std::span<const Rays> counts) {
    const std::size_t size = totals.size();
    const auto add = [](Rays& sum, const Rays& r) {
        sum.traced += r.traced;
        sum.passed += r.passed;
    };
    const auto shrunk = [](const Rays& r, double towards, double weight) {
        return (r.passed + weight * towards) / (r.traced + weight);
    };
    Rays all;
    for (const Rays& total : totals) add(all, total);
    std::vector<double> visible(64 * size);
    for (std::size_t slot = 0; slot < size; ++slot) {
        Rays group;
        for (std::size_t i = slot / 8 * 8; i < std::min(slot / 8 * 8 + 8, size); ++i)
            add(group, totals[i]);
        const double of_slot = shrunk(totals[slot], shrunk(group, shrunk(all, 0.7, 1), 1), 1);
        for (std::size_t cell = 0; cell < 64; ++cell) visible[64 * slot + cell] = of_slot;
    }
    // Parts of the tile, smaller and smaller, of so many cells.
    for (const std::size_t cells : {16, 4, 1}) {
        for (std::size_t part = 0; part < 64; part += cells) {
            std::vector<Rays> rays(size);
            Rays seen;
            double expected = 0;  // to pass, of those traced
            for (std::size_t slot = 0; slot < size; ++slot) {
                for (std::size_t cell = part; cell < part + cells; ++cell)
                    add(rays[slot], counts[64 * slot + cell]);
                add(seen, rays[slot]);
                expected += rays[slot].traced * visible[64 * slot + part];
            }
            const double passed = (seen.passed + 1) / (expected + 1);
            const double stopped = (seen.traced - seen.passed + 1) / (seen.traced - expected + 1);
            for (std::size_t slot = 0; slot < size; ++slot) {
                const double share = visible[64 * slot + part];
                const double odds = share * passed / ((1 - share) * stopped);
                const double result = shrunk(rays[slot], odds / (1 + odds), 8);
                for (std::size_t cell = part; cell < part + cells; ++cell)
                    visible[64 * slot + cell] = result;
            }
        }
    }
    for (double& v : visible) v = std::max(v, 0.0005);
    return visible;
}

namespace {

// By how much rounding of a point's height over the plane of a light with area changes the
// luminance of node_estimate().
double estimate_rounding(const LightTree& tree, uint index, const Point& point) {
    const LightNode& node = tree.nodes[index];
    const Light& light = tree.lights[node.first];
    if (node.count > 1 || !has_area(light)) return 0;
    const glm::dvec3 n = glm::cross(glm::dvec3(light.axis), glm::dvec3(light.edge));
    const glm::dvec3 position(point.surface.position);
    const double reach = std::max(glm::length(position), glm::length(glm::dvec3(light.position)));
    const glm::dvec3 step = 4.0 * std::numeric_limits<float>::epsilon() * reach * glm::normalize(n);
    // A step may be less than the last place of a coordinate: the slope comes from a longer one.
    constexpr double longer = 64;
    const auto luminance_at = [&](double steps) {
        Surface moved = point.surface;
        moved.position = float4(glm::vec3(position + steps * step), moved.position.w);
        return luminance(node_estimate(tree, index, {point.scene, point.camera, moved}));
    };
    const double here = luminance_at(0);
    return std::max(std::abs(luminance_at(longer) - here), std::abs(luminance_at(-longer) - here)) /
           longer;
}

}  // namespace

std::vector<PixelDraws> draw_nodes(const LightTree& tree, const Scene& scene, const Camera& camera,
                                   std::span<const uint> cut, std::span<const DrawnPixel> pixels,
                                   const Budget& budget) {
    struct Entry {
        uint slot, node;
    };
    bool doubt = false;
    const auto estimate_of = [&](const Entry& e, const DrawnPixel& p) {
        return p.surface ? node_estimate(tree, e.node, {scene, camera, *p.surface}) : glm::dvec3(0);
    };
    const auto weight_of = [&](const Entry& e, const DrawnPixel& p) {
        // Its mean is the contribution x V^, of which 0.8 is the control variate's.
        const double v = p.visible[e.slot];
        const double variance = tree.nodes[e.node].count > 1 ? 0.5 : 0;
        return luminance(estimate_of(e, p)) * std::sqrt(v * (1 + variance - 0.96 * v));
    };
    std::vector<Entry> list;
    for (uint slot = 0; slot < cut.size(); ++slot) list.push_back({slot, cut[slot]});
    std::vector<double> sums(pixels.size(), 0);
    for (const Entry& e : list)
        for (std::size_t i = 0; i < pixels.size(); ++i) sums[i] += weight_of(e, pixels[i]);
    // What is close to any of the pixels is replaced by its children.
    int splits = 0;
    for (std::size_t at = 0; at < list.size();) {
        const Entry e = list[at];
        const LightNode& node = tree.nodes[e.node];
        bool wanted = false;
        for (std::size_t i = 0; i < pixels.size() && node.count > 1; ++i) {
            if (!pixels[i].surface) continue;
            const double distance =
                glm::length(glm::dvec3(node.centre) - glm::dvec3(pixels[i].surface->position));
            const double near = NODE_IS_INFINITE(node)
                                    ? double{node.intensity.w}
                                    : std::min(node.intensity.w / std::max(distance, 1e-20), 1.0);
            const double limit = sums[i] * 0.25 / budget.samples;
            const double size = weight_of(e, pixels[i]) * near;
            wanted = wanted || size > limit;
            if (size > 0 && std::abs(size / limit - 1) < doubtful / 4) doubt = true;
        }
        if (!wanted || splits >= 64) {
            ++at;
            continue;
        }
        ++splits;
        const Entry children[] = {{e.slot, e.node + 1}, {e.slot, right_child(tree, e.node)}};
        list[at] = children[0];
        list.insert(list.begin() + static_cast<std::ptrdiff_t>(at) + 1, children[1]);
    }
    std::vector<PixelDraws> out;
    for (const DrawnPixel& pixel : pixels) {
        PixelDraws& d = out.emplace_back();
        d.uncertain = doubt;
        if (!pixel.surface) continue;
        std::vector<double> weights;
        double sum = 0;
        double estimates_blur = 0;
        for (const Entry& e : list) {
            d.control += pixel.visible[e.slot] * estimate_of(e, pixel);
            weights.push_back(weight_of(e, pixel));
            sum += weights.back();
            estimates_blur += estimate_rounding(tree, e.node, {scene, camera, *pixel.surface});
        }
        // Where weights are hardly more than rounding, so is what is drawn.
        if (estimates_blur > 2e-4 * sum) d.uncertain = true;
        const double brightness = luminance(d.control);
        d.variance = std::max(sum * sum - (0.04 - 0.004) * brightness * brightness, 0.0);
        double samples = budget.samples;
        if (budget.factor > 0) {
            const double wanted =
                budget.factor * budget.exposure *
                std::sqrt(d.variance / (std::pow(brightness * budget.exposure, 2) + 0.01));
            samples = std::clamp<double>(wanted, FEWEST_DRAWS * budget.samples,
                                         MOST_DRAWS * budget.samples);
            if (std::abs(wanted - 1) < doubtful) d.uncertain = true;
            if (samples >= 1) {
                const double exact = samples + pixel.starts.rounding;
                if (std::abs(exact - std::round(exact)) < doubtful * samples) d.uncertain = true;
                samples = std::floor(exact);
            }
        }
        const double all = samples * 0.999999;
        double scale = sum > 0 ? all / sum : 0;
        for (int round = 0; round < 8 && sum > 0; ++round) {
            double rest = 0;
            double certain = 0;
            for (std::size_t i = 0; i < list.size(); ++i) {
                if (single_point(tree.nodes[list[i].node]) && weights[i] * scale >= 1)
                    certain += 1;
                else
                    rest += weights[i];
            }
            if (!(rest > 0 && all - certain > 0.01)) break;
            scale = std::max((all - certain) / rest, scale);
        }
        double position = pixel.starts.position;
        double blur = 1e-6;  // of the position
        for (std::size_t i = 0; i < list.size(); ++i) {
            const double exact_share = weights[i] * scale;
            const bool single = single_point(tree.nodes[list[i].node]);
            const double share = single ? std::min(exact_share, 1.0) : exact_share;
            const double reached = position + share;
            blur += 1e-5 * share + 1e-7;
            // Close to where a draw begins, but for nodes that are passed exactly.
            const double whole = std::round(reached);
            if (whole > 0 && std::abs(reached - whole) < blur) d.uncertain = true;
            d.nodes.push_back({list[i].slot, list[i].node, share, weights[i],
                               luminance(estimate_of(list[i], pixel))});
            for (int k = 0; k < static_cast<int>(reached); ++k) d.draws.push_back(d.nodes.back());
            position = reached - std::floor(reached);
        }
    }
    return out;
}

Descent descend(const LightTree& tree, uint node, const Point& point, double u, uint bits) {
    Descent d{0, 1};
    for (uint step = 0; tree.nodes[node].count > 1; ++step) {
        const uint right = right_child(tree, node);
        const double a = luminance(node_estimate(tree, node + 1, point));
        const double b = luminance(node_estimate(tree, right, point));
        if (a + b == 0) return {0, 0, d.uncertain};
        if (step > 0) u = unit_fraction(step_bits(bits, step));
        const double p = a / (a + b);
        if (std::abs(u - p) < 1e-5) d.uncertain = true;
        d.probability *= u < p ? p : 1 - p;
        node = u < p ? node + 1 : right;
    }
    d.light = tree.nodes[node].first;
    return d;
}

namespace {

float shifted_gradient_noise(uint x, uint y, float shift) {
    const auto fraction = [](float v) { return std::min(v - std::floor(v), 0x1.fffffep-1f); };
    const float inner =
        fraction(0.06711056f * static_cast<float>(x) + 0.00583715f * static_cast<float>(y));
    return fraction(52.9829189f * inner + shift);
}

}  // namespace

Starts draw_starts(uint x, uint y, const Pass& pass, uint pixel_sample, uint seed) {
    const auto bits = random_bits(16 * pass.number + pass.first, pixel_sample, 0xfffffffdu, seed);
    const auto shift = [&](int i) { return static_cast<float>(unit_fraction(bits[i])); };
    return {shifted_gradient_noise(x, y, shift(0)), shifted_gradient_noise(y, x, shift(1))};
}

}  // namespace manylight::reference
