// SPDX-License-Identifier: MIT
#include "reference/material/ggx.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

namespace manylight::reference {
namespace {

constexpr double pi = glm::pi<double>();

double microfacet_distribution(double a2, double n_h) {
    const double d = n_h * n_h * (a2 - 1) + 1;
    return a2 / (pi * d * d);
}

double smith_visibility(double a2, double n_l, double n_v) {
    const auto term = [a2](double c) { return 1 / (c + std::sqrt(a2 + (1 - a2) * c * c)); };
    return term(n_l) * term(n_v);
}

}  // namespace

double ggx_lobe(double alpha, double n_h, double n_l, double n_v) {
    const double a2 = alpha * alpha;
    return microfacet_distribution(a2, n_h) * smith_visibility(a2, n_l, n_v);
}

double widened_ggx_lobe(double a2, double n_h, double n_l, double n_v) {
    return microfacet_distribution(a2, std::clamp(n_h, -1.0, 1.0)) * smith_visibility(a2, n_l, n_v);
}

double ggx_density(double alpha, double n_h, double n_v) {
    const double a2 = alpha * alpha;
    if (n_h <= 0) return 0;
    return microfacet_distribution(a2, n_h) / (2 * (n_v + std::sqrt(a2 + (1 - a2) * n_v * n_v)));
}

double schlick_part(double cosine) { return std::pow(std::max(1 - std::abs(cosine), 0.0), 5); }

glm::dvec3 sample_lobe(double alpha, const glm::dvec3& normal, const glm::dvec3& wo,
                       const glm::dvec2& u) {
    // A frame about the normal: Duff et al., "Building an Orthonormal Basis, Revisited" (JCGT 6:1,
    // 2017).
    const glm::dvec3& n = normal;
    const double sign = std::copysign(1.0, n.z);
    const double a = -1 / (sign + n.z);
    const glm::dmat3 frame(glm::dvec3(1 + sign * n.x * n.x * a, sign * n.x * n.y * a, -sign * n.x),
                           glm::dvec3(n.x * n.y * a, sign + n.y * n.y * a, -n.y), n);
    const glm::dvec3 stretch(alpha, alpha, 1);
    const glm::dvec3 viewer = glm::normalize(stretch * (glm::transpose(frame) * wo));
    const double height = glm::mix(1.0, -viewer.z, u.y);  // of the cap of directions to the viewer
    const double radius = std::sqrt(std::max(1 - height * height, 0.0));
    const double phi = 2 * glm::pi<double>() * u.x;
    const glm::dvec3 half =
        viewer + glm::dvec3(radius * std::cos(phi), radius * std::sin(phi), height);
    return -glm::reflect(wo, glm::normalize(frame * (stretch * half)));
}

double light_share(double density, double solid_angle, double count) {
    const double light = count / solid_angle;
    return solid_angle > 0 ? light * light / (light * light + density * density) : 1;
}

}  // namespace manylight::reference
