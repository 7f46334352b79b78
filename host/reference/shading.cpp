// SPDX-License-Identifier: MIT
#include "reference/shading.hpp"

#include <algorithm>
#include <glm/gtc/constants.hpp>

namespace manylight::reference {
namespace {

constexpr double pi = glm::pi<double>();
constexpr double epsilon = std::numeric_limits<float>::epsilon();

// D and V as appendix B of the glTF 2.0 specification writes them.
double microfacet_distribution(double alpha, double n_h) {
    const double a2 = alpha * alpha;
    const double d = n_h * n_h * (a2 - 1) + 1;
    return a2 / (pi * d * d);
}

double smith_visibility(double alpha, double n_l, double n_v) {
    const double a2 = alpha * alpha;
    const auto term = [a2](double c) { return 1 / (c + std::sqrt(a2 + (1 - a2) * c * c)); };
    return term(n_l) * term(n_v);
}

// By how much rounding may have changed what a light's emission comes from.
struct LightShift {
    glm::dvec3 normal = glm::dvec3(0);   // of an area: of the cross product of its sides, m2
    double versine = 0;                  // of a spot: 1 - the cosine to its axis
    glm::dvec3 towards = glm::dvec3(0);  // of a directional one: unit direction to it
};

struct Emission {
    glm::dvec3 towards;  // unit, to the light
    glm::dvec3 target;   // end of the shadow ray
    glm::dvec3 light;    // illuminance at normal incidence, lx
    bool infinite = false;
    double solid_angle = 0;  // of a light with area, sr
    glm::dvec3 moved{0};     // by how much rounding moves the target along each axis, m
};

double range_window(double distance, double range) {
    if (range == 0) return 1;
    return std::clamp(1 - std::pow(distance / range, 4), 0.0, 1.0);
}

Emission punctual(const Light& light, const glm::dvec3& position) {
    Emission e;
    e.target = glm::dvec3(light.position);
    const glm::dvec3 d = e.target - position;
    const double distance = glm::length(d);
    e.light = glm::dvec3(0);
    if (distance == 0) return e;
    e.towards = d / distance;
    e.light =
        glm::dvec3(light.emission) * (range_window(distance, light.axis.w) / (distance * distance));
    return e;
}

// Of the angle at which a spot shines.
double cosine_to_axis(const Light& light, const Emission& e) {
    return glm::dot(-e.towards, glm::normalize(glm::dvec3(light.axis)));
}

Emission spot(const Light& light, const glm::dvec3& position, const LightShift& shift) {
    Emission e = punctual(light, position);
    const double versine = 1 - cosine_to_axis(light, e) + shift.versine;
    const double cone = std::clamp((light.edge.y - versine) * light.edge.x, 0.0, 1.0);
    e.light *= cone * cone;
    return e;
}

Emission directional(const Light& light) {
    return {-glm::dvec3(light.axis), glm::dvec3(0), glm::dvec3(light.emission), true};
}

// Intensity times cosine at `point` of an emitter with that unit normal.
Emission lambertian(const glm::dvec3& position, const glm::dvec3& point, glm::dvec3 normal,
                    const glm::dvec3& intensity, double offset, bool both_sides) {
    Emission e;
    e.light = glm::dvec3(0);
    e.target = point;
    const glm::dvec3 d = point - position;
    const double squared = glm::dot(d, d);
    if (squared == 0) return e;
    e.towards = d / std::sqrt(squared);
    double cosine = glm::dot(-e.towards, normal);
    if (cosine < 0 && both_sides) {
        cosine = -cosine;
        normal = -normal;
    }
    if (cosine <= 0) return e;
    e.light = intensity * cosine / squared;
    e.target += normal * offset;
    return e;
}

Emission oriented(const Light& light, const glm::dvec3& position) {
    return lambertian(position, glm::dvec3(light.position), glm::dvec3(light.axis),
                      glm::dvec3(light.emission), light.edge.w, false);
}

// Of the cross product of an area's sides, m2: each part is a difference of two products.
double normal_rounding(const Light& light) {
    return 2 * epsilon * glm::length(glm::dvec3(light.axis)) * glm::length(glm::dvec3(light.edge));
}

Emission quad(const Light& light, const glm::dvec3& position, const glm::dvec2& u,
              const LightShift& shift) {
    const glm::dvec3 e1(light.axis);
    const glm::dvec3 e2(light.edge);
    const glm::dvec3 n = glm::cross(e1, e2) + shift.normal;
    const double area = glm::length(n);
    // With radiance 1, what is received is the solid angle.
    Emission e = lambertian(position, glm::dvec3(light.position) + u.x * e1 + u.y * e2, n / area,
                            glm::dvec3(area), light.edge.w, light.axis.w != 0);
    e.solid_angle = e.light.x;
    // On which side the target is may be in doubt, too.
    const double turn = normal_rounding(light) / area;
    const bool doubtful = std::abs(glm::dot(e.towards, n)) <= turn * area;
    const glm::dvec3 p(light.position);
    const glm::dvec3 farthest = glm::max(glm::max(glm::abs(p), glm::abs(p + e1)),
                                         glm::max(glm::abs(p + e2), glm::abs(p + e1 + e2)));
    e.moved = 4 * epsilon * farthest + light.edge.w * (doubtful ? 2 : std::min(2 * turn, 2.0));
    e.light *= glm::dvec3(light.emission);
    return e;
}

// Half a parallelogram.
Emission triangle(const Light& light, const glm::dvec3& position, glm::dvec2 u,
                  const LightShift& shift) {
    // Which half of the square is decided in single precision.
    if (static_cast<float>(u.x) + static_cast<float>(u.y) > 1) u = 1.0 - u;
    Emission e = quad(light, position, u, shift);
    e.light /= 2;
    e.solid_angle /= 2;
    return e;
}

Emission emission(const Light& light, const glm::dvec3& position, const glm::dvec2& u,
                  const LightShift& shift = {}) {
    switch (static_cast<LightKind>(light.position.w)) {
        case LIGHT_POINT:
            return punctual(light, position);
        case LIGHT_SPOT:
            return spot(light, position, shift);
        case LIGHT_DIRECTIONAL:
            return directional(light);
        case LIGHT_ORIENTED:
            return oriented(light, position);
        case LIGHT_TRIANGLE:
            return triangle(light, position, u, shift);
        case LIGHT_QUAD:
            return quad(light, position, u, shift);
        case light_kind_count:
            break;
    }
    return {};
}

// Of 1 - the cosine to a spot's axis, sin^2 / (1 + cos): the sine is a cross product, off by 4
// units, and 4 units of the whole.
double versine_rounding(double cosine) {
    const double sine = std::sqrt(std::max(1 - cosine * cosine, 0.0));
    return 4 * epsilon * (2 * sine / (1 + std::max(cosine, 0.0)) + (1 - cosine));
}

Unshadowed shade(const glm::dvec3& position, const Surface& surface, const Material& material,
                 const Viewer& viewer, const Light& light, const glm::dvec2& u, double count,
                 const LightShift& shift = {}) {
    const glm::dvec3 normal = glm::normalize(glm::dvec3(surface.normal));
    const glm::dvec3 horizon(surface.horizon);
    Emission e = emission(light, position, u, shift);
    if (e.infinite) e.towards += shift.towards;
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
    } else if (light.edge.y != 0) {
        const double along = glm::dot(glm::dvec3(light.axis), out.shadow.origin);
        const double length = std::max(along - light.edge.x, 1e-30);
        out.shadow.direction *= length;
        out.shadow.end = 1;
        out.rounding.end = glm::dvec3(
            4 * epsilon * (glm::length(out.shadow.origin) + std::abs(double{light.edge.x})));
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
    const double distribution = microfacet_distribution(material.roughness, glm::dot(normal, h));
    const double a2 = double{material.roughness} * material.roughness;
    // Heitz (2018), eq. 17: G1 D / (4 N.V), where G1 is 2 N.V / (N.V + root).
    if (glm::dot(normal, h) > 0)
        f.density = distribution / (2 * (n_v + std::sqrt(a2 + (1 - a2) * n_v * n_v)));
    if (n_l <= 0) return f;
    const double lobe = distribution * smith_visibility(material.roughness, n_l, n_v);
    const double schlick = std::pow(std::max(1 - std::abs(glm::dot(wo, h)), 0.0), 5);
    const glm::dvec3 base(material.base_color);
    const double f90 = material.specular;
    const glm::dvec3 f0 = f90 * glm::dvec3(material.reflectance);
    const glm::dvec3 dielectric_fresnel = f0 + (f90 - f0) * schlick;
    const double most =
        std::max({dielectric_fresnel.r, dielectric_fresnel.g, dielectric_fresnel.b});
    const double metallic = material.base_color.w;
    f.diffuse = (1 - metallic) * (1 - most) * base / pi;
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
        if (has_area(light)) slack += change(glm::dvec3(0), {normal_rounding(light) * along});
        if (e.infinite) slack += change(glm::dvec3(0), {.towards = 4 * epsilon * along});
    }
    if (static_cast<LightKind>(light.position.w) == LIGHT_SPOT)
        slack += change(glm::dvec3(0), {glm::dvec3(0), versine_rounding(cosine_to_axis(light, e))});
    return slack;
}

}  // namespace manylight::reference
