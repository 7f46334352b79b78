// SPDX-License-Identifier: MIT
// A function for every kind of light: what the host computes of it beyond its traits. A kind
// without one does not compile.
#include <algorithm>
#include <glm/gtc/constants.hpp>

#include "lights/lights.hpp"

namespace manylight {
namespace {

constexpr float pi = glm::pi<float>();

struct Kind {
    float (*power)(const Light& light, float luminance, float radius);
    Extent<float> (*extent)(const Light& light);
    Extent<double> (*exact_extent)(const Light& light);
};

template <class Number>
Extent<Number> extent_of_point(const Light& light) {
    const glm::vec<3, Number> p(light.position);
    return {{p, p, p, p}, p, 1, 0};
}

template <class Number>
Extent<Number> extent_of_direction(const Light& light) {
    const glm::vec<3, Number> to(-glm::vec3(light.axis));
    return {{to, to, to, to}, to, 1, 0};
}

template <class Number>
Extent<Number> extent_of_quad(const Light& light) {
    const glm::vec<3, Number> p(light.position);
    const glm::vec<3, Number> u(light.axis);
    const glm::vec<3, Number> v(light.edge);
    const auto area = static_cast<Number>(glm::length(area_normal(light)));
    const Number squares = glm::dot(u, u) + glm::dot(v, v);
    return {{p, p + u, p + v, p + u + v}, p + (u + v) / Number{2}, area, squares / 12};
}

template <class Number>
Extent<Number> extent_of_triangle(const Light& light) {
    const glm::vec<3, Number> p(light.position);
    const glm::vec<3, Number> u(light.axis);
    const glm::vec<3, Number> v(light.edge);
    const auto area = static_cast<Number>(glm::length(area_normal(light)));
    const Number squares = glm::dot(u, u) + glm::dot(v, v);
    return {
        {p, p + u, p + v, p}, p + (u + v) / Number{3}, area / 2, (squares - glm::dot(u, v)) / 18};
}

// The area of all emitting sides of the parallelogram of a light's axis and edge, m2.
float parallelogram(const Light& light) {
    const double area = glm::length(area_normal(light));
    return static_cast<float>(area * (light.axis.w != 0 ? 2 : 1));
}

Kind point() {
    return {[](const Light&, float luminance, float) { return 4 * pi * luminance; },
            extent_of_point<float>, extent_of_point<double>};
}

Kind spot() {
    return {[](const Light& light, float luminance, float) {
                // Over the sphere, its 1 - cosine is uniform; the mean of the square where it fades
                // is a third.
                return 2 * pi * luminance * std::max(light.edge.y - 2 / (3 * light.edge.x), 0.f);
            },
            extent_of_point<float>, extent_of_point<double>};
}

Kind directional() {
    return {[](const Light&, float luminance, float radius) {
                return luminance * pi * radius * radius;
            },
            extent_of_direction<float>, extent_of_direction<double>};
}

Kind oriented() {
    return {[](const Light&, float luminance, float) { return pi * luminance; },
            extent_of_point<float>, extent_of_point<double>};
}

Kind triangle() {
    return {[](const Light& light, float luminance, float) {
                return pi * luminance * parallelogram(light) / 2;
            },
            extent_of_triangle<float>, extent_of_triangle<double>};
}

Kind quad() {
    return {[](const Light& light, float luminance, float) {
                return pi * luminance * parallelogram(light);
            },
            extent_of_quad<float>, extent_of_quad<double>};
}

const Kind& row(const Light& light) {
#define LIGHT_ROW(name, NAME, value, traits, centroid) name(),
    static const Kind rows[] = {LIGHT_KINDS(LIGHT_ROW)};
#undef LIGHT_ROW
    static_assert(std::size(rows) == light_kind_count);
    return rows[kind_of(light)];
}

// How a light shines no kind leaves open.
constexpr bool is_one(int traits) { return traits != 0 && (traits & (traits - 1)) == 0; }
#define LIGHT_EMISSION(name, NAME, value, traits, centroid) \
    static_assert(is_one((traits) & (TRAIT_EVEN | TRAIT_CONE | TRAIT_COSINE)));
LIGHT_KINDS(LIGHT_EMISSION)
#undef LIGHT_EMISSION

}  // namespace

const char* name_of(LightKind kind) {
#define LIGHT_NAME(name, NAME, value, traits, centroid) #name,
    static const char* names[] = {LIGHT_KINDS(LIGHT_NAME)};
#undef LIGHT_NAME
    return names[kind];
}

float power_of(const Light& light, float luminance, float radius) {
    return row(light).power(light, luminance, radius);
}

template <>
Extent<float> extent_of<float>(const Light& light) {
    return row(light).extent(light);
}

template <>
Extent<double> extent_of<double>(const Light& light) {
    return row(light).exact_extent(light);
}

glm::vec3 axis_of(const Light& light) {
    if (!has_axis(light)) return glm::vec3(0);
    return light_has(light, TRAIT_AREA) ? glm::vec3(glm::normalize(area_normal(light)))
                                        : glm::vec3(light.axis);
}

}  // namespace manylight
