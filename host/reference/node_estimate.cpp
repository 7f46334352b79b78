// SPDX-License-Identifier: MIT
#include "reference/node_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "reference/lights/lights.hpp"
#include "reference/material/ggx.hpp"
#include "reference/material/lambert.hpp"

namespace manylight::reference {
namespace {

// max(k, 0) smoothed over sqrt(v).
double soft(double k, double v) {
    const double root = std::sqrt(k * k + v);
    return k >= 0 ? (k + root) / 2 : (v == 0 ? 0 : v / (2 * (root - k)));
}

// glTF's BRDF with a lobe of squared width a2, for a direction that may be below the surface.
glm::dvec3 widened_brdf(const Material& m, const glm::dvec3& n, const glm::dvec3& wi,
                        const glm::dvec3& wo, double spread) {
    const glm::dvec3 base(m.base_color);
    if (m.base_color.w == 0 && m.specular == 0) return lambert(base);
    const glm::dvec3 sum = wi + wo;
    if (glm::dot(sum, sum) < 1e-20) return glm::dvec3(0);  // from behind
    const glm::dvec3 h = glm::normalize(sum);
    const double a2 = double{m.roughness} * m.roughness + spread / 4;
    const double lobe = widened_ggx_lobe(a2, glm::dot(n, h), std::max(glm::dot(n, wi), 0.0),
                                         std::max(std::abs(glm::dot(n, wo)), 1e-4));
    const double schlick = schlick_part(glm::dot(wo, h));
    const glm::dvec3 f0(m.reflectance);
    const glm::dvec3 fresnel = double{m.specular} * (f0 + (1.0 - f0) * schlick);
    const double most = std::max({fresnel.r, fresnel.g, fresnel.b});
    const glm::dvec3 dielectric = (1 - most) * lambert(base) + lobe * fresnel;
    const glm::dvec3 metal = lobe * (base + (1.0 - base) * schlick);
    return glm::mix(dielectric, metal, double{m.base_color.w});
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
    return std::clamp(1 + REACH_EDGE * inside, 0.0, 1.0);
}

}  // namespace

uint right_child(const LightTree& tree, uint node) { return node + 2 * tree.nodes[node + 1].count; }

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
        if (const auto leaf = leaf_emission(node, light, d, softened)) {
            emission = *leaf;
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
    const glm::dvec3 to_camera = point.viewer.direction(glm::dvec3(s.position));
    return point.viewer.throughput() * glm::dvec3(node.intensity) * factor *
           widened_brdf(point.material(), normal, towards, to_camera, spread);
}

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
        return luminance(node_estimate(tree, index, {point.scene, point.viewer, moved}));
    };
    const double here = luminance_at(0);
    return std::max(std::abs(luminance_at(longer) - here), std::abs(luminance_at(-longer) - here)) /
           longer;
}

}  // namespace manylight::reference
