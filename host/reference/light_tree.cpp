// SPDX-License-Identifier: MIT
#include "reference/light_tree.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "reference/shading.hpp"

namespace manylight::reference {

NodeView view_node(const LightNode& node, const Surface& surface) {
    constexpr double close = 1e-5;     // to where the cosines end
    constexpr double rounding = 1e-6;  // of a cosine
    const glm::dvec3 normal(surface.normal);
    NodeView view;
    if (NODE_IS_INFINITE(node)) {
        const double cosine = glm::dot(normal, glm::dvec3(node.centre)) + double{node.intensity.w};
        view.cosines = std::clamp(cosine, 0.0, 1.0);
        view.doubtful = std::abs(cosine) < close;
        if (cosine > 0) view.slack = rounding / cosine;
        return view;
    }
    const glm::dvec3 lower(node.lower);
    const glm::dvec3 upper(node.upper);
    view.radius = glm::length(upper - lower) / 2;
    const glm::dvec3 towards = (lower + upper) / 2.0 - glm::dvec3(surface.position);
    view.distance = glm::length(towards);
    view.doubtful = view.radius > 0 && std::abs(view.distance / view.radius - 1) < close;
    view.cosines = 1;
    if (view.distance <= view.radius) return view;
    const auto angle = [](double cosine) { return std::acos(std::clamp(cosine, -1.0, 1.0)); };
    const double by_bounds = std::asin(view.radius / view.distance);
    const double incidence =
        std::max(angle(glm::dot(normal, towards / view.distance)) - by_bounds, 0.0);
    view.doubtful = view.doubtful || std::abs(incidence - glm::half_pi<double>()) < close;
    view.cosines = incidence < glm::half_pi<double>() ? std::cos(incidence) : 0;
    double slack = 1 / view.cosines;
    if (node.upper.w <= 1) {
        const glm::dvec3 axis(node.cone);
        const double off_axis =
            std::max(std::atan2(glm::length(glm::cross(axis, towards)), -glm::dot(axis, towards)) -
                         angle(1 - double{node.lower.w}) - by_bounds,
                     0.0);
        const double beyond = (1 - std::cos(off_axis)) / node.upper.w - 1;
        view.doubtful = view.doubtful || std::abs(beyond) < 1e-3;
        view.cosines *= off_axis > 0 && beyond >= 0 ? 0 : std::cos(off_axis);
        slack += 1 / std::cos(off_axis);
    }
    if (view.cosines > 0) view.slack = rounding * (1 + 1 / std::cos(by_bounds)) * slack;
    return view;
}

double importance(const LightNode& node, const Surface& surface) {
    const NodeView view = view_node(node, surface);
    if (NODE_IS_INFINITE(node)) return luminance(glm::dvec3(node.intensity)) * view.cosines;
    const double floor = std::max(view.distance, view.radius);
    return floor > 0 ? double{node.cone.w} * view.cosines / (floor * floor) : 0;
}

}  // namespace manylight::reference
