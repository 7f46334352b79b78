// SPDX-License-Identifier: MIT
#include "reference/textures.hpp"

#include <algorithm>
#include <cmath>

#include "reference/triangle.hpp"
#include "scene/textures.hpp"

namespace manylight::reference {
namespace {

// The texel that is shown at place i of an endless row of them.
unsigned shown(double i, unsigned side, uint wrap) {
    const double n = side;
    double place = 0;
    switch (wrap) {
        case WRAP_REPEAT:
            place = i - n * std::floor(i / n);
            break;
        case WRAP_MIRROR: {
            const double twice = i - 2 * n * std::floor(i / (2 * n));
            place = twice < n ? twice : 2 * n - 1 - twice;
            break;
        }
        default:
            place = std::clamp(i, 0.0, n - 1);
    }
    return static_cast<unsigned>(place);
}

glm::dvec4 sample_level(const Scene& scene, const Texture& t, unsigned level, const glm::dvec2& uv,
                        bool linear) {
    const unsigned width = std::max(t.width >> level, 1u);
    const unsigned height = std::max(t.height >> level, 1u);
    const auto texel = [&](double i, double j) {
        return glm::dvec4(
            texel_of(scene, t, level, shown(i, width, t.wrap_u), shown(j, height, t.wrap_v)));
    };
    const glm::dvec2 at = uv * glm::dvec2(width, height);
    if (!linear) return texel(std::floor(at.x), std::floor(at.y));
    // Every texel counts by how near its centre is.
    glm::dvec4 sum(0);
    const glm::dvec2 corner = glm::floor(at - 0.5);
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            const glm::dvec2 distance = glm::abs(corner + glm::dvec2(i, j) + 0.5 - at);
            sum += (1 - distance.x) * (1 - distance.y) * texel(corner.x + i, corner.y + j);
        }
    return sum;
}

// How a point's weights of vertices 1 and 2 change from a pixel to its neighbours, by its ray's
// differentials (Igehy, "Tracing Ray Differentials", 1999): the columns are by x and y.
glm::dmat2 weight_differentials(const glm::dvec3 v[3], const Ray& ray, double t) {
    const glm::dvec3 normal = glm::cross(v[1] - v[0], v[2] - v[0]);
    const double squared = glm::dot(normal, normal);
    glm::dmat2 out(0.0);
    for (int k = 0; k < 2; ++k) {
        glm::dvec3 moved = ray.origin_change[k] + t * ray.direction_change[k];
        moved -= glm::dot(moved, normal) / glm::dot(ray.direction, normal) * ray.direction;
        out[k] = {glm::dot(normal, glm::cross(moved, v[2] - v[0])) / squared,
                  glm::dot(normal, glm::cross(v[1] - v[0], moved)) / squared};
    }
    return out;
}

// A hit of a ray and what is interpolated there.
class Point {
  public:
    Point(const Scene& scene, const Ray& ray, const Hit& hit)
        : scene_(scene), ray_(ray), hit_(hit), triangle_(scene, hit.triangle) {}

    [[nodiscard]] const Triangle& triangle() const { return triangle_; }

    [[nodiscard]] glm::dvec4 interpolate(const glm::dvec4& v0, const glm::dvec4& v1,
                                         const glm::dvec4& v2) const {
        return (1 - hit_.u - hit_.v) * v0 + hit_.u * v1 + hit_.v * v2;
    }

    [[nodiscard]] glm::dvec4 color() const {
        const std::vector<float4>& colors = scene_.colors;
        if (colors.empty()) return glm::dvec4(1);
        return interpolate(colors[triangle_.vertex(0)], colors[triangle_.vertex(1)],
                           colors[triangle_.vertex(2)]);
    }

    [[nodiscard]] glm::dvec4 tangent() const {
        return interpolate(triangle_.tangent(0), triangle_.tangent(1), triangle_.tangent(2));
    }

    /// The material's map of a kind; null if it has none.
    [[nodiscard]] const TextureMap* map(MapKind kind) const {
        if (scene_.maps.empty()) return nullptr;
        const TextureMap& map = scene_.maps[MAP_KIND_COUNT * triangle_.material() + kind];
        return map.texture == NO_TEXTURE ? nullptr : &map;
    }

    /// Where corner k is on a map's texture.
    [[nodiscard]] glm::dvec2 corner(const TextureMap& map, int k) const {
        const glm::dvec3 st(scene_.coordinates[map.set][triangle_.vertex(k)], 1);
        return {glm::dot(glm::dvec3(map.u), st), glm::dot(glm::dvec3(map.v), st)};
    }

    /// How (u, v) changes with the weights of vertices 1 and 2: the columns.
    [[nodiscard]] glm::dmat2 corner_change(const TextureMap& map) const {
        return {corner(map, 1) - corner(map, 0), corner(map, 2) - corner(map, 0)};
    }

    /// What the map of a kind holds here; 1 if there is none.
    [[nodiscard]] glm::dvec4 value_of(MapKind kind) const {
        const TextureMap* map = this->map(kind);
        if (!map) return glm::dvec4(1);
        const glm::dmat2 change = corner_change(*map);
        const glm::dvec3 v[3] = {triangle_.corner(0), triangle_.corner(1), triangle_.corner(2)};
        const double area =
            std::abs(glm::determinant(change * weight_differentials(v, ray_, hit_.t)));
        return sample_texture(scene_, scene_.textures[map->texture],
                              corner(*map, 0) + change * glm::dvec2(hit_.u, hit_.v), area);
    }

  private:
    const Scene& scene_;
    const Ray& ray_;
    const Hit& hit_;
    Triangle triangle_;
};

}  // namespace

glm::dvec4 sample_texture(const Scene& scene, const Texture& t, const glm::dvec2& uv, double area) {
    // By how much texels are smaller than the pixel: in octaves.
    const double level = area > 0 ? 0.5 * std::log2(area * t.width * t.height) : -1;
    if (level <= 0) return sample_level(scene, t, 0, uv, t.magnified_linear != 0);
    const bool linear = t.minified_linear != 0;
    const double at = std::min<double>(level, t.levels - 1);
    if (t.between == LEVELS_FINEST) return sample_level(scene, t, 0, uv, linear);
    if (t.between == LEVELS_NEAREST)
        return sample_level(scene, t, static_cast<unsigned>(std::floor(at + 0.5)), uv, linear);
    const double finer = std::floor(at);
    const double coarser = std::ceil(at);
    return glm::mix(sample_level(scene, t, static_cast<unsigned>(finer), uv, linear),
                    sample_level(scene, t, static_cast<unsigned>(coarser), uv, linear), at - finer);
}

Material material_at(const Scene& scene, const Ray& ray, const Hit& hit) {
    const Point point(scene, ray, hit);
    Material out = scene.materials[point.triangle().material()];
    const glm::dvec3 color(point.value_of(MAP_BASE_COLOR) * point.color());
    const glm::dvec4 polish = point.value_of(MAP_METALLIC_ROUGHNESS);
    const glm::dvec3 emission = glm::dvec3(out.emission) * glm::dvec3(point.value_of(MAP_EMISSION));
    const glm::dvec3 base = glm::dvec3(out.base_color) * (out.unlit ? glm::dvec3(1) : color);
    out.base_color = float4(glm::vec3(base), out.base_color.w * polish.b);
    out.emission = float4(glm::vec3(out.unlit ? emission * color : emission), out.emission.w);
    out.specular *= static_cast<float>(point.value_of(MAP_SPECULAR).a);
    const glm::dvec3 reflectance =
        glm::dvec3(out.reflectance) * glm::dvec3(point.value_of(MAP_SPECULAR_COLOR));
    out.reflectance = float4(glm::vec3(glm::min(reflectance, 1.0)), 0);
    const double root = std::sqrt(double{out.roughness}) * polish.g;
    out.roughness = static_cast<float>(std::max<double>(root * root, SMALLEST_ALPHA));
    return out;
}

double alpha_at(const Scene& scene, const Hit& hit) {
    const Ray no_pixel{glm::dvec3(0), glm::dvec3(1)};
    const Point point(scene, no_pixel, hit);
    const double alpha = scene.materials[point.triangle().material()].alpha;
    return alpha * point.color().a * point.value_of(MAP_BASE_COLOR).a;
}

glm::dvec3 normal_at(const Scene& scene, const Ray& ray, const Hit& hit, const glm::dvec3& normal) {
    const Point point(scene, ray, hit);
    const TextureMap* map = point.map(MAP_NORMAL);
    if (!map) return normal;
    const glm::dvec3 in = (2.0 * glm::dvec3(point.value_of(MAP_NORMAL)) - 1.0) *
                          glm::dvec3(map->scale, map->scale, 1);
    const Triangle& triangle = point.triangle();
    const glm::dvec3 face = triangle.face();
    const double side = glm::dot(face, ray.direction) < 0 ? 1 : -1;
    glm::dvec4 tangent = point.tangent();
    if (glm::dvec3(tangent) == glm::dvec3(0)) {
        // The columns of the inverse of d(u, v) / d(weights) are d(weights) / du and / dv.
        const glm::dmat2 inverse = glm::inverse(point.corner_change(*map));
        const auto along = [&](int k) {
            return inverse[k][0] * (triangle.corner(1) - triangle.corner(0)) +
                   inverse[k][1] * (triangle.corner(2) - triangle.corner(0));
        };
        // glTF's y is up, and v down.
        const bool mirrored = glm::dot(glm::cross(along(0), -along(1)), face) < 0;
        tangent = glm::dvec4(along(0), mirrored ? -1 : 1);
    }
    glm::dvec3 x(tangent);
    x -= glm::dot(x, normal) * normal;
    if (!(glm::length(x) > 0)) return normal;
    x = glm::normalize(x);
    // Seen from behind, the whole frame is turned round.
    const glm::dvec3 y = tangent.w * glm::cross(side * normal, x);
    const glm::dvec3 mapped = side * (in.x * x + in.y * y) + in.z * normal;
    return mapped == glm::dvec3(0) ? normal : glm::normalize(mapped);
}

}  // namespace manylight::reference
