// SPDX-License-Identifier: MIT
#include "reference/samplers/octree.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "reference/contributions.hpp"
#include "reference/random.hpp"

namespace manylight::reference {
namespace {

constexpr double pi = glm::pi<double>();
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double epsilon = std::numeric_limits<float>::epsilon();
// Differences in a decision that single precision may not see: of bounds, relative, which grow with
// the lobe's; of angles, radians, and of shares.
constexpr double doubtful_bound = 1e-4;
constexpr double doubtful = 1e-6;

struct Range {
    double least, most;
};

double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

Range widened(double angle, double by) {
    return {std::max(angle - by, 0.0), std::min(angle + by, pi)};
}

double positive_cosine(double angle) { return std::max(std::cos(angle), 0.0); }

// Of |cosine|.
Range cosine_sizes(const Range& angles) {
    const double a = std::abs(std::cos(angles.least));
    const double b = std::abs(std::cos(angles.most));
    const bool crosses = angles.least < pi / 2 && angles.most >= pi / 2;
    return {crosses ? 0 : std::min(a, b), std::max(a, b)};
}

Range emission_range(const OctreeNode& node, const glm::dvec3& towards, double spread,
                     bool& is_doubtful) {
    Range all{infinity, 0};
    const auto add = [&](const Range& kind) {
        all.least = std::min(all.least, kind.least);
        all.most = std::max(all.most, kind.most);
    };
    const double half_angle = 2 * std::asin(std::sqrt(std::min(node.cone.w / 2.0, 1.0)));
    const Range off = widened(angle_between(-glm::dvec3(node.cone), towards), half_angle + spread);
    if ((node.emits & EMITS_EVENLY) != 0) add({1, 1});
    if ((node.emits & EMITS_FRONT) != 0)
        add({positive_cosine(off.most), positive_cosine(off.least)});
    if ((node.emits & EMITS_BOTH) != 0) add(cosine_sizes(off));
    if ((node.emits & EMITS_CONE) != 0) {
        const auto angle_of = [](double versine) {
            return 2 * std::asin(std::sqrt(std::clamp(versine / 2, 0.0, 1.0)));
        };
        const double inner = angle_of(node.inner);
        is_doubtful = is_doubtful || std::abs(off.most - inner) < 4 * doubtful;
        add({node.inner >= 0 && off.most <= inner ? 1. : 0.,
             off.least < angle_of(node.outer) ? 1. : 0.});
    }
    return all;
}

double virtual_emission(const OctreeNode& node, const glm::dvec3& towards) {
    const double along = -glm::dot(glm::dvec3(node.axis), towards);
    const bool both = (node.emits & EMITS_BOTH) != 0;
    return node.axis.w + (both ? std::abs(along) : std::max(along, 0.0));
}

double range_window(double distance, double inverse_square) {
    return std::clamp(1 - std::pow(distance * distance * inverse_square, 2), 0.0, 1.0);
}

// GGX's D with Smith's masking, shadowing and the cosine, over 4 cosines.
double lobe_cosine(double alpha, double half_angle, double n_in, double n_out) {
    if (n_in <= 0) return 0;
    const double c2 = std::pow(std::cos(half_angle), 2);
    const double s2 = std::pow(std::sin(half_angle), 2);
    const double a2 = alpha * alpha;
    const double d = a2 / (pi * std::pow(s2 + a2 * c2, 2));
    const auto visibility = [&](double c) { return 1 / (c + std::sqrt(a2 + (1 - a2) * c * c)); };
    return d * visibility(n_in) * visibility(n_out) * n_in;
}

// BRDF times cosine, of Lambert's part with one Fresnel term of Schlick's and of the lobe with
// another.
glm::dvec3 reflected(const Material& m, double cosine, double lobe, double base, double gloss) {
    const double f90 = m.specular;
    const glm::dvec3 f0 = f90 * glm::dvec3(m.reflectance);
    const glm::dvec3 below = glm::mix(f0, glm::dvec3(f90), base);
    const glm::dvec3 color(m.base_color);
    const double metallic = m.base_color.w;
    const double kept = 1 - std::max({below.r, below.g, below.b});
    const glm::dvec3 dielectric =
        color * (kept * cosine / pi) + lobe * glm::mix(f0, glm::dvec3(f90), gloss);
    return glm::mix(dielectric, lobe * glm::mix(color, glm::dvec3(1), gloss), metallic);
}

double schlick(double cosine) { return std::pow(1 - std::clamp(cosine, 0.0, 1.0), 5); }

// Of directions within `spread` of `towards`.
NodeBounds bound_brdf(const Point& point, const glm::dvec3& towards, double spread, bool shared) {
    const Material& m = point.material();
    const glm::dvec3 normal(point.surface.normal);
    const glm::dvec3 wo = point.viewer.direction(glm::dvec3(point.surface.position));
    const double incidence = angle_between(normal, towards);
    const Range in = widened(incidence, spread);
    const Range cosine{positive_cosine(in.most), positive_cosine(in.least)};
    if (m.base_color.w == 0 && m.specular == 0) {
        const glm::dvec3 albedo = glm::dvec3(m.base_color) / pi;
        return {albedo * cosine.least, albedo * cosine.most, albedo * positive_cosine(incidence),
                false};
    }
    const glm::dvec3 sum = towards + wo;
    const glm::dvec3 h = sum / std::max(glm::length(sum), 1e-6);
    const double n_out = std::max(std::abs(glm::dot(normal, wo)), 1e-4);
    const double difference = angle_between(wo, h);
    const double widest = difference + spread / 2;
    const double turn = std::tan(spread / 2) / std::max(std::cos(widest), 1e-6);
    const double theta = angle_between(normal, h);
    const bool anywhere = turn >= 1 || glm::dot(sum, sum) <= 1e-6;
    const Range half = anywhere ? Range{0, pi / 2} : widened(theta, std::asin(turn));
    const bool crosses = half.least < pi / 2 && half.most >= pi / 2;
    const auto from_line = [](double angle) { return std::min(angle, pi - angle); };
    const double near = std::min(from_line(half.least), from_line(half.most));
    const double far = crosses ? pi / 2 : std::max(from_line(half.least), from_line(half.most));
    const double a = m.roughness;
    const double grazing = schlick(std::cos(widest));
    const double steep = schlick(std::cos(std::max(difference - spread / 2, 0.0)));
    const double s = schlick(std::cos(difference));
    const double least = shared ? 0 : lobe_cosine(a, far, cosine.least, n_out);
    const double middle = shared ? 0 : lobe_cosine(a, theta, positive_cosine(incidence), n_out);
    return {reflected(m, cosine.least, least, grazing, steep),
            reflected(m, cosine.most, lobe_cosine(a, near, cosine.most, n_out), steep, grazing),
            reflected(m, positive_cosine(incidence), middle, s, s), false};
}

// `slack`: of the bounds, relative.
bool is_alike(const NodeBounds& b, const OctreeNode& node, const glm::dvec3& error, double slack) {
    for (int c = 0; c < 3; ++c) {
        const double off = std::max(b.most[c] - b.estimate[c], b.estimate[c] - b.least[c]);
        const double intensity = node.intensity[c];
        if (!(off * intensity <= error[c] * (1 + slack) + slack * b.most[c] * intensity))
            return false;
    }
    return true;
}

}  // namespace

NodeBounds bound_node(const OctreeNode& node, const Point& point) {
    const glm::dvec3 to_centre = glm::dvec3(node.centre) - glm::dvec3(point.surface.position);
    const double distance = glm::length(to_centre);
    const double sine = distance > 0 ? node.centre.w / distance + OCTREE_MARGIN : 1;
    if (sine >= 1) return {glm::dvec3(0), glm::dvec3(infinity), glm::dvec3(0), false};
    const glm::dvec3 towards = to_centre / distance;
    const double spread = std::asin(sine);
    bool is_doubtful = false;
    const Range emission = emission_range(node, towards, spread, is_doubtful);
    const double elevation = pi / 2 - angle_between(glm::dvec3(point.surface.horizon), towards);
    if (elevation <= -spread || emission.most <= 0)
        return {glm::dvec3(0), glm::dvec3(0), glm::dvec3(0), false};
    const bool shared =
        (node.emits & EMITS_AREA) != 0 && reflects(point.surface, point.material(), point.viewer);
    NodeBounds out = bound_brdf(point, towards, spread, shared);
    const double nearest = distance * (1 - sine);
    const double farthest = distance * (1 + sine);
    out.least *= elevation <= spread ? 0
                                     : emission.least * range_window(farthest, node.near_range) /
                                           (farthest * farthest);
    out.most *= emission.most * range_window(nearest, node.far_range) / (nearest * nearest);
    const double window = (range_window(distance, node.near_range) +  //
                           range_window(distance, node.far_range)) /
                          2;
    out.estimate *=
        elevation <= 0 ? 0 : virtual_emission(node, towards) * window / (distance * distance);
    out.least *= point.viewer.throughput();
    out.most *= point.viewer.throughput();
    out.estimate *= point.viewer.throughput();
    out.doubtful = is_doubtful || std::abs(elevation - spread) < 4 * doubtful;
    return out;
}

glm::dvec3 Octree::total(const Point& point) const {
    glm::dvec3 sum(0);
    for (uint i = 0; i < nodes_.size();) {
        const OctreeNode& node = nodes_[i];
        if (is_leaf(i)) {
            const Light& light = point.scene.lights[node.light];
            sum += unshadowed(point.surface, point.material(), point.viewer, light, centroid(light))
                       .value;
        } else {
            const double distance =
                glm::length(glm::dvec3(node.centre) - glm::dvec3(point.surface.position));
            if (node.centre.w >= OCTREE_SMALL * distance) {
                ++i;
                continue;
            }
            const NodeBounds b = bound_node(node, point);
            sum += glm::min(b.estimate, b.most) * glm::dvec3(node.intensity);
        }
        i = node.next;
    }
    return sum;
}

std::vector<uint> Octree::cut(const Point& point, int* undecided) const {
    const glm::dvec3 error = epsilon_ * total(point);
    std::vector<uint> out;
    for (uint i = 0; i < nodes_.size();) {
        const OctreeNode& node = nodes_[i];
        if (is_leaf(i)) {
            out.push_back(i++);
            continue;
        }
        const NodeBounds bounds = bound_node(node, point);
        const bool dark = bounds.most == glm::dvec3(0);
        const bool alike = !dark && epsilon_ > 0 && is_alike(bounds, node, error, 0);
        if (undecided != nullptr && !dark && epsilon_ > 0 &&
            (bounds.doubtful || is_alike(bounds, node, error, doubtful_bound) !=
                                    is_alike(bounds, node, error, -doubtful_bound)))
            ++*undecided;
        if (alike) out.push_back(i);
        i = dark || alike ? node.next : i + 1;
    }
    return out;
}

// One of the node's lights.
Octree::Term Octree::draw(const Point& point, uint node, const PixelDraws& draws) const {
    Term term{};
    const auto bits = random_bits(draws.pixel, draws.pixel_sample, nodes_[node].light, draws.seed);
    const auto weight_of = [&](uint i) { return luminance(glm::dvec3(nodes_[i].intensity)); };
    double probability = 1;
    for (uint step = 0; !is_leaf(node); ++step) {
        const double total = weight_of(node);
        const uint end = nodes_[node].next;
        double left = unit_fraction(step_bits(bits[0], step)) * total;
        uint child = node + 1;
        while (true) {
            if (nodes_[child].next == end) break;
            if (std::abs(left - weight_of(child)) < doubtful * total) term.borderline = true;
            if (left < weight_of(child)) break;
            left -= weight_of(child);
            child = nodes_[child].next;
        }
        probability *= weight_of(child) / total;
        node = child;
    }
    const Light& light = point.scene.lights[nodes_[node].light];
    const glm::dvec2 u(unit_fraction(bits[1]), unit_fraction(bits[2]));
    const Unshadowed found = unshadowed(point.surface, point.material(), point.viewer, light, u);
    term.value = found.value / probability;
    term.shadow = found.shadow;
    term.rounding = found.rounding;
    if (draws.judge)
        term.slack =
            rounding_slack(point.surface, point.material(), point.viewer, light, u) / probability;
    return term;
}

Octree::Term Octree::shade_virtual(const Point& point, uint node, bool judge) const {
    const OctreeNode& n = nodes_[node];
    const glm::dvec3 intensity(n.intensity);
    const auto value_at = [&](const glm::dvec3& shift) {
        Surface moved = point.surface;
        moved.position += float4(glm::vec3(shift), 0);
        return intensity * bound_node(n, {point.scene, point.viewer, moved}).estimate;
    };
    Term term{};
    term.value = value_at(glm::dvec3(0));
    const Surface& s = point.surface;
    const glm::dvec3 position(s.position);
    glm::dvec3 target(n.centre);
    const double to_light = glm::length(target - position);
    const glm::dvec3 axis(n.axis);
    if (axis != glm::dvec3(0)) {
        const double side = glm::dot(axis, position - target) < 0 ? -1 : 1;
        target += side * double{n.intensity.w} * glm::normalize(axis);
    }
    term.shadow.origin = position + glm::dvec3(s.horizon) * double{s.horizon.w};
    term.shadow.direction = target - term.shadow.origin;
    term.shadow.end = 1;
    term.rounding = {origin_rounding(s, term.shadow.origin), 4 * epsilon * glm::abs(target)};
    if (!judge) return term;
    const double largest =
        std::max({std::abs(position.x), std::abs(position.y), std::abs(position.z), to_light,
                  point.viewer.distance(position)});
    for (int axis_number = 0; axis_number < 3; ++axis_number) {
        glm::dvec3 shift(0);
        shift[axis_number] = 8 * epsilon * largest;
        term.slack +=
            glm::length(value_at(shift) - term.value) + glm::length(value_at(-shift) - term.value);
    }
    return term;
}

Estimate Octree::estimate(const Tracer& tracer, const Point& point, const PixelDraws& draws) const {
    Estimate out;
    if (point.surface.position.w < 0) return out;
    const std::vector<uint> nodes = cut(point, &out.undecided);
    out.uncertain = out.undecided > 0;
    for (const uint node : nodes) {
        const bool to_virtual = to_virtual_ && !is_leaf(node);
        const Term term =
            to_virtual ? shade_virtual(point, node, draws.judge) : draw(point, node, draws);
        out.uncertain = out.uncertain || term.borderline;
        out.undecided += term.borderline ? 1 : 0;
        out.slack += term.slack;
        if (term.value == glm::dvec3(0)) continue;
        if (!tracer.occluded(term.shadow)) {
            out.value += term.value;
            out.magnitude += term.value;
        }
        if (draws.judge && tracer.occlusion_is_borderline(term.shadow, term.rounding)) {
            out.borderline += glm::length(term.value);
            ++out.undecided;
        }
    }
    return out;
}

}  // namespace manylight::reference
