// SPDX-License-Identifier: MIT
#include "reference/shading.hpp"

#include <algorithm>

#include "reference/lights/lights.hpp"
#include "reference/material/ggx.hpp"
#include "reference/material/lambert.hpp"

namespace manylight::reference {
namespace {

constexpr double epsilon = std::numeric_limits<float>::epsilon();

Unshadowed shade(const glm::dvec3& position, const Surface& surface, const Material& material,
                 const Viewer& viewer, const Light& light, const glm::dvec2& u, double count,
                 const LightShift& shift = {}) {
    const glm::dvec3 normal = glm::normalize(glm::dvec3(surface.normal));
    const glm::dvec3 horizon(surface.horizon);
    const Emission e = emission(light, position, u, shift);
    Unshadowed out;
    out.value = glm::dvec3(0);
    if (e.light == glm::dvec3(0)) return out;
    const double cosine = glm::dot(normal, e.towards);
    if (cosine <= 0 || glm::dot(horizon, e.towards) <= 0) return out;
    const Brdf f = split_brdf(material, normal, e.towards, viewer.direction(position));
    const double share =
        reflects(surface, material, viewer) ? light_share(f.density, e.solid_angle, count) : 1;
    out.value = (f.diffuse + f.specular * share) * e.light * cosine * viewer.throughput();
    out.shadow.origin = position + horizon * static_cast<double>(surface.horizon.w);
    out.shadow.direction = e.infinite ? e.towards : e.target - out.shadow.origin;
    out.rounding = {origin_rounding(surface, out.shadow.origin), e.moved};
    if (!e.infinite) {
        out.shadow.end = 1;
    } else if (e.plane) {
        const double along = -glm::dot(e.towards, out.shadow.origin);
        const double length = std::max(along - *e.plane, 1e-30);
        out.shadow.direction *= length;
        out.shadow.end = 1;
        out.rounding.end =
            glm::dvec3(4 * epsilon * (glm::length(out.shadow.origin) + std::abs(*e.plane)));
    }
    return out;
}

}  // namespace

Brdf split_brdf(const Material& material, const glm::dvec3& normal, const glm::dvec3& wi,
                const glm::dvec3& wo) {
    Brdf f;
    const double n_l = glm::dot(normal, wi);
    const double n_v = std::max(std::abs(glm::dot(normal, wo)), 1e-4);
    const glm::dvec3 h = glm::normalize(wi + wo);
    const double n_h = glm::dot(normal, h);
    f.density = ggx_density(material.roughness, n_h, n_v);
    if (n_l <= 0) return f;
    const double lobe = ggx_lobe(material.roughness, n_h, n_l, n_v);
    const double schlick = schlick_part(glm::dot(wo, h));
    const glm::dvec3 base(material.base_color);
    const double f90 = material.specular;
    const glm::dvec3 f0 = f90 * glm::dvec3(material.reflectance);
    const glm::dvec3 dielectric_fresnel = f0 + (f90 - f0) * schlick;
    const double most =
        std::max({dielectric_fresnel.r, dielectric_fresnel.g, dielectric_fresnel.b});
    const double metallic = material.base_color.w;
    f.diffuse = (1 - metallic) * (1 - most) * lambert(base);
    f.specular = lobe * glm::mix(dielectric_fresnel, base + (1.0 - base) * schlick, metallic);
    return f;
}

glm::dvec3 brdf(const Material& material, const glm::dvec3& normal, const glm::dvec3& wi,
                const glm::dvec3& wo) {
    const Brdf f = split_brdf(material, normal, wi, wo);
    return f.diffuse + f.specular;
}

glm::dvec3 origin_rounding(const Surface& surface, const glm::dvec3& origin) {
    return epsilon * (glm::abs(origin) + double{surface.horizon.w});
}

bool reflects(const Surface& surface, const Material& material, const Viewer& viewer) {
    const glm::dvec3 wo = viewer.direction(glm::dvec3(surface.position));
    return (material.base_color.w > 0 || material.specular > 0) &&
           material.roughness < REFLECTING_ALPHA && glm::dot(glm::dvec3(surface.normal), wo) > 1e-4;
}

Unshadowed unshadowed(const Surface& surface, const Material& material, const Viewer& viewer,
                      const Light& light, const glm::dvec2& u, double count) {
    return shade(glm::dvec3(surface.position), surface, material, viewer, light, u, count);
}

double rounding_slack(const Surface& surface, const Material& material, const Viewer& viewer,
                      const Light& light, const glm::dvec2& u, double count) {
    const glm::dvec3 position(surface.position);
    const Emission e = emission(light, position, u);
    const double largest =
        std::max({std::abs(position.x), std::abs(position.y), std::abs(position.z),
                  std::abs(e.target.x), std::abs(e.target.y), std::abs(e.target.z)});
    const double to_light = e.infinite ? 1 : glm::length(e.target - position);
    const double shift = 8 * epsilon * std::max({largest, to_light, viewer.distance(position)});
    const glm::dvec3 centre = shade(position, surface, material, viewer, light, u, count).value;
    const auto change = [&](const glm::dvec3& step, const LightShift& light_shift) {
        double most = 0;
        for (const double sign : {-1.0, 1.0}) {
            const LightShift to{sign * light_shift.normal, sign * light_shift.versine,
                                sign * light_shift.towards};
            const glm::dvec3 value =
                shade(position + sign * step, surface, material, viewer, light, u, count, to).value;
            most = std::max(most, glm::length(value - centre));
        }
        return most;
    };
    double slack = 0;
    for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 along(0);
        along[axis] = 1;
        slack += change(shift * along, {});
    }
    for (const LightShift& own : light_shifts(light, position)) slack += change(glm::dvec3(0), own);
    return slack;
}

}  // namespace manylight::reference
