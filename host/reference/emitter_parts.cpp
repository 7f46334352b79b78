// SPDX-License-Identifier: MIT
#include "reference/emitter_parts.hpp"

#include "reference/gbuffer.hpp"
#include "reference/random.hpp"
#include "reference/textures.hpp"
#include "reference/triangle.hpp"

namespace manylight::reference {
namespace {

constexpr double epsilon = std::numeric_limits<float>::epsilon();

// A camera's image plane, in pixels from the top left corner.
class ImagePlane {
  public:
    ImagePlane(const Camera& camera, const Tiles& tiles)
        : from_world_(glm::inverse(glm::dmat3(glm::dvec3(camera.right), glm::dvec3(camera.up),
                                              glm::dvec3(camera.forward)))),
          origin_(camera.origin),
          half_size_(0.5 * tiles.width, 0.5 * tiles.height),
          orthographic_(camera.forward.w != 0) {}
    [[nodiscard]] glm::dvec2 place(const glm::dvec3& point) const {
        const glm::dvec3 at = from_world_ * (point - origin_);
        const glm::dvec2 image = orthographic_ ? glm::dvec2(at) : glm::dvec2(at) / at.z;
        return half_size_ + glm::dvec2(image.x, -image.y) * half_size_;
    }

  private:
    glm::dmat3 from_world_;
    glm::dvec3 origin_;
    glm::dvec2 half_size_;
    bool orthographic_;
};

// A part, in pixels.
struct OnFilm {
    glm::dvec2 corner, ways[2];
    [[nodiscard]] double area() const {
        return std::abs(ways[0].x * ways[1].y - ways[0].y * ways[1].x) / 2;
    }
};

OnFilm on_film(const ImagePlane& plane, const Triangle& triangle, const EmitterPart& part) {
    const auto place = [&](double u, double v) {
        return plane.place(triangle.corner(0) * (1 - u - v) + triangle.corner(1) * u +
                           triangle.corner(2) * v);
    };
    const double x = part.corner.x, y = part.corner.y;
    const glm::dvec2 corner = place(x, y);
    return {corner,
            {place(x + part.corner.z, y + part.corner.w) - corner,
             place(x + part.way_2.x, y + part.way_2.y) - corner}};
}

// Which half of the square is decided in single precision.
glm::dvec2 in_triangle(const glm::dvec2& u) {
    return static_cast<float>(u.x) + static_cast<float>(u.y) > 1 ? 1.0 - u : u;
}

}  // namespace

PartLight part_light(const Scene& scene, const Camera& camera, const Tiles& tiles,
                     const EmitterPart& part, uint number, uint stride, uint pixel_sample,
                     uint seed) {
    const Triangle triangle(scene, part.triangle);
    const ImagePlane plane(camera, tiles);
    const OnFilm film = on_film(plane, triangle, part);
    const auto scramble = random_bits(number, 0, 0xfffffffbu, seed);
    const glm::dvec2 u = in_triangle(sobol_point(pixel_sample / stride, scramble[0], scramble[1]));
    const Ray ray =
        primary_ray(camera, tiles, film.corner + u.x * film.ways[0] + u.y * film.ways[1]);
    // Where that meets the triangle's plane.
    const glm::dvec3 v0 = triangle.corner(0);
    const glm::dvec3 face = triangle.face();
    const glm::dvec3 side1 = triangle.corner(1) - v0, side2 = triangle.corner(2) - v0;
    const double t = glm::dot(v0 - ray.origin, face) / glm::dot(ray.direction, face);
    const glm::dvec3 position = ray.origin + t * ray.direction;
    const glm::dvec2 weights(
        glm::dot(glm::cross(position - v0, side2), face) / glm::dot(face, face),
        glm::dot(glm::cross(side1, position - v0), face) / glm::dot(face, face));

    PartLight out;
    out.shadow.origin = ray.origin + ray.start * ray.direction;
    glm::dvec3 normal = glm::normalize(face);
    if (glm::dot(normal, ray.direction) > 0) normal = -normal;
    glm::dvec3 sizes(0);
    for (int k = 0; k < 3; ++k) sizes = glm::max(sizes, glm::abs(triangle.corner(k)));
    const double offset = OFFSET_SCALE * glm::dot(glm::abs(normal), sizes);
    out.shadow.direction = position + normal * offset - out.shadow.origin;
    out.shadow.end = 1;
    out.rounding = {4 * epsilon * (glm::abs(out.shadow.origin) + glm::abs(position)),
                    8 * epsilon * sizes};

    const auto emission = [&](const glm::dvec2& step) {
        const glm::dvec2 w = weights + step;
        return glm::dvec3(
            glm::vec3(material_at(scene, ray, {part.triangle, t, w.x, w.y}).emission));
    };
    const glm::dvec3 emitted = emission({0, 0});
    const double covered = film.area();
    out.value = emitted * covered * double(stride);
    // What it is made of is rounded, and so are places on the film.
    double rounded = 1e-12;
    for (const auto vector : {&EmitterPart::corner, &EmitterPart::way_2})
        for (int k = 0; k < (vector == &EmitterPart::corner ? 4 : 2); ++k) {
            EmitterPart moved = part;
            (moved.*vector)[k] *= 1 + static_cast<float>(4 * epsilon);
            rounded += std::abs(on_film(plane, triangle, moved).area() - covered);
        }
    out.slack = glm::length(emitted) * rounded * stride;
    for (const glm::dvec2& step : {glm::dvec2(1, 0), {-1, 0}, {0, 1}, {0, -1}})
        out.slack += glm::length(emission(64 * epsilon * step) - emitted) * covered * stride;
    return out;
}

}  // namespace manylight::reference
