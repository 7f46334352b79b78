// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <optional>

#include "lights/lights.hpp"
#include "scene/area_lights.hpp"
#include "scene/textures.hpp"
#include "shared/surface.h"

namespace manylight {
namespace {

// A triangle of an emitter on one of its textures, where its material has that.
class TextureOn {
  public:
    TextureOn(const Scene& scene, const Emitter& e, MapKind kind) {
        if (!has_map(scene, e.material, kind)) return;
        const TextureMap& map = scene.maps[MAP_KIND_COUNT * e.material + kind];
        texture_ = &scene.textures[map.texture];
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t vertex = scene.indices[3 * std::size_t{e.triangle} + k];
            const glm::vec3 st(scene.coordinates[map.set][vertex], 1);
            at_[k] = {glm::dot(glm::vec3(map.u), st), glm::dot(glm::vec3(map.v), st)};
        }
    }
    [[nodiscard]] const Texture* texture() const { return texture_; }
    // Coordinates of a point, and of a vector, by its weights of vertices 1 and 2.
    [[nodiscard]] glm::dvec2 point(glm::dvec2 weights) const {
        return glm::dvec2(at_[0]) + vector(weights);
    }
    [[nodiscard]] glm::dvec2 vector(glm::dvec2 weights) const {
        return weights.x * glm::dvec2(at_[1] - at_[0]) + weights.y * glm::dvec2(at_[2] - at_[0]);
    }

  private:
    const Texture* texture_ = nullptr;
    glm::vec2 at_[3] = {};
};

// How much of an emitter is there (kernels/lib/alpha.h).
class Coverage {
  public:
    Coverage(const Scene& scene, const Emitter& e)
        : scene_(scene),
          cutoff_(scene.materials[e.material].cutoff),
          base_(scene, e, MAP_BASE_COLOR) {
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t vertex = scene.indices[3 * std::size_t{e.triangle} + k];
            alphas_[k] = scene.materials[e.material].alpha *
                         (scene.colors.empty() ? 1 : scene.colors[vertex].a);
        }
    }
    // Whether it is not the same everywhere.
    [[nodiscard]] bool varies() const {
        return cutoff_ != 0 && (base_.texture() || !scene_.colors.empty());
    }
    // The texels of the finest level along a vector.
    [[nodiscard]] double texels(glm::dvec2 v) const {
        if (!base_.texture()) return 0;
        return glm::length(base_.vector(v) *
                           glm::dvec2(base_.texture()->width, base_.texture()->height));
    }
    [[nodiscard]] double at(glm::dvec2 weights) const {
        if (cutoff_ == 0) return 1;
        double alpha = alphas_[0] + weights.x * (alphas_[1] - alphas_[0]) +
                       weights.y * (alphas_[2] - alphas_[0]);
        if (base_.texture())
            alpha *= finest_texel(scene_, *base_.texture(), base_.point(weights)).a;
        if (cutoff_ > 0) return alpha >= cutoff_ ? 1 : 0;
        return std::clamp(alpha, 0.0, 1.0);
    }

  private:
    const Scene& scene_;
    double cutoff_;
    TextureOn base_;
    double alphas_[3];
};

// Points along a side of a part, over which it is averaged; as many as texels where these say what
// is there, if these are not too many for all parts of an emitter.
constexpr double least_points = 16;
constexpr double most_points = 128;
constexpr double points_of_emitter = 1 << 23;

glm::vec3 radiance_of_part(const Scene& scene, const Emitter& e, glm::dvec2 corner, glm::dvec2 u,
                           glm::dvec2 v, bool triangle) {
    const TextureOn emission(scene, e, MAP_EMISSION);
    const Coverage coverage(scene, e);
    double points = least_points;
    if (coverage.varies()) {
        const double share = std::abs(u.x * v.y - u.y * v.x);  // of the emitter, a part's
        const double most =
            std::clamp(std::sqrt(points_of_emitter * share), least_points, most_points);
        points = std::clamp(std::ceil(std::max(coverage.texels(u), coverage.texels(v))),
                            least_points, most);
    }
    const int side = static_cast<int>(points);
    std::optional<TextureLevel> texels;
    if (emission.texture())
        texels.emplace(scene, *emission.texture(), emission.vector(u) / static_cast<double>(side),
                       emission.vector(v) / static_cast<double>(side));
    glm::dvec3 sum(0);
    for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i) {
            glm::dvec2 at = (glm::dvec2(i, j) + 0.5) / static_cast<double>(side);
            // The half beyond the triangle, turned onto it.
            if (triangle && at.x + at.y > 1) at = 1.0 - at;
            const glm::dvec2 weights = corner + at.x * u + at.y * v;
            const double there = coverage.at(weights);
            if (there == 0) continue;
            sum += there * (texels ? texels->at(emission.point(weights)) : glm::dvec3(1));
        }
    return glm::vec3(scene.materials[e.material].emission) *
           glm::vec3(sum / static_cast<double>(side * side));
}

// Whether an emitter's radiance varies over it, and the mean. Returns whether any of it may shine.
bool find_radiance(const Scene& scene, Emitter& e) {
    const Coverage coverage(scene, e);
    e.varies = has_map(scene, e.material, MAP_EMISSION) || coverage.varies();
    e.radiance = e.varies ? radiance_of_part(scene, e, {0, 0}, {1, 0}, {0, 1}, true)
                          : glm::vec3(scene.materials[e.material].emission) *
                                static_cast<float>(coverage.at({0, 0}));
    return e.radiance != glm::vec3(0) || coverage.varies();
}

// As long as the parallelogram is large; single precision would lose the square of a small one.
glm::dvec3 face_of(const Emitter& e) {
    return glm::cross(glm::dvec3(e.edge1()), glm::dvec3(e.edge2()));
}

std::vector<Emitter> find_emitters(const Scene& scene) {
    std::vector<Emitter> emitters;
    for (std::size_t t = 0; t < scene.triangle_count(); ++t) {
        const Material& material = scene.materials[scene.triangle_materials[t]];
        if (glm::vec3(material.emission) == glm::vec3(0)) continue;
        if (material.unlit != 0) continue;
        Emitter e{{}, material.emission, material.emission.w != 0, 0, 0, 0, 0};
        e.material = scene.triangle_materials[t];
        e.triangle = static_cast<std::uint32_t>(t);
        glm::vec3 extent(0);
        for (int corner = 0; corner < 3; ++corner) {
            e.vertices[corner] = scene.vertices[scene.indices[3 * t + corner]];
            extent = glm::max(extent, glm::abs(e.vertices[corner]));
        }
        const glm::dvec3 face(face_of(e));
        const double area = glm::length(face) / 2;
        if (!(area > 0)) continue;
        if (!find_radiance(scene, e)) continue;
        e.offset = static_cast<float>(OFFSET_SCALE *
                                      glm::dot(glm::abs(face) / (2 * area), glm::dvec3(extent)));
        e.power = glm::pi<double>() * area * luminance(e.radiance) * (e.both_sides ? 2 : 1);
        emitters.push_back(e);
    }
    return emitters;
}

// Emission of power `power` from the point (u, v) of one side of an emitter.
Light oriented_point(const Emitter& e, glm::vec2 u, bool back, double power) {
    if (u.x + u.y > 1) u = 1.f - u;
    const glm::vec3 color = e.radiance / luminance(e.radiance);
    const glm::vec3 normal(glm::normalize(face_of(e)));
    return {float4(e.vertices[0] + u.x * e.edge1() + u.y * e.edge2(), LIGHT_ORIENTED),
            float4(back ? -normal : normal, 0), float4(0, 0, 0, e.offset),
            float4(color * static_cast<float>(power / glm::pi<double>()), 0)};
}

// Lights from `first` on are `by` places further.
void shift_lights(LightCells& cells, std::uint32_t first, std::uint32_t by) {
    for (std::uint32_t& light : cells.lights)
        if (light != NO_LIGHT && light >= first) light += by;
}

// Point i lies where (i + 1/2) / points of the power is reached, counting the sides of all emitters
// in order; on a side, the points follow Roberts' R2 sequence.
std::vector<Light> make_points(const std::vector<Emitter>& emitters, unsigned points) {
    std::vector<Light> lights;
    double total = 0;
    for (const Emitter& e : emitters) total += e.power;
    double before = 0;
    for (const Emitter& e : emitters) {
        const int sides = e.both_sides ? 2 : 1;
        for (int side = 0; side < sides; ++side) {
            before += e.power / sides;
            for (unsigned k = 1;
                 lights.size() < points &&
                 (static_cast<double>(lights.size()) + 0.5) * total < before * points;
                 ++k) {
                const glm::dvec2 step(0.7548776662466927, 0.5698402909980532);
                const glm::dvec2 u = glm::fract(0.5 + static_cast<double>(k) * step);
                lights.push_back(oriented_point(e, u, side == 1, total / points));
            }
        }
    }
    return lights;
}

// What emission.w of a light is; see shared/light.h.
float power_in(const Light& light, const Bounds& bounds) {
    return power_of(light, luminance(light.emission), bounds.radius());
}

// The cells of emitters, of their triangles, whose lights will be the scene's last.
LightCells cells_in_scene(const Scene& scene, const std::vector<Emitter>& emitters,
                          AreaLights made) {
    LightCells cells;
    cells.grid_of.assign(scene.triangle_count(), NO_GRID);
    for (std::size_t i = 0; i < emitters.size(); ++i)
        cells.grid_of[emitters[i].triangle] = static_cast<std::uint32_t>(i);
    cells.grids = std::move(made.grids);
    cells.lights = std::move(made.cell_lights);
    shift_lights(cells, 0, static_cast<std::uint32_t>(scene.lights.size()));
    return cells;
}

}  // namespace

void add_emitters(Scene& scene, unsigned points) {
    const std::vector<Emitter> emitters = find_emitters(scene);
    std::vector<Light> lights;
    if (points > 0) {
        lights = make_points(emitters, points);
    } else if (!emitters.empty()) {
        AreaLights made = make_area_lights(
            emitters,
            [&scene](const Emitter& e, glm::dvec2 corner, glm::dvec2 u, glm::dvec2 v,
                     bool triangle) { return radiance_of_part(scene, e, corner, u, v, triangle); });
        lights = std::move(made.lights);
        if (!lights.empty()) scene.light_cells = cells_in_scene(scene, emitters, std::move(made));
    }
    scene.lights.insert(scene.lights.end(), lights.begin(), lights.end());
    const Bounds bounds = scene.bounds();
    for (Light& light : scene.lights) light.emission.w = power_in(light, bounds);
}

bool is_dark(const Scene& scene) {
    return scene.lights.empty() &&
           std::ranges::none_of(scene.triangle_materials, [&](std::uint32_t material) {
               const Material& m = scene.materials[material];
               return m.unlit != 0 && glm::vec3(m.emission) != glm::vec3(0);
           });
}

void add_headlight(Scene& scene, const View& view) {
    constexpr double pi = glm::pi<double>();
    constexpr double brightest = 1e15;  // cd, as of a file's own lights
    const Bounds bounds = scene.bounds();
    const glm::dvec3 forward(-view.to_world[2]);
    Light light{};
    if (view.orthographic) {
        light.position.w = LIGHT_DIRECTIONAL;
        light.axis = float4(glm::vec3(forward), 0);
        const glm::dvec3 place = glm::dvec3(view.to_world[3]) + view.near * forward;
        light.edge = float4(static_cast<float>(glm::dot(forward, place)), 1, 0, 0);
        light.emission = float4(glm::vec3(static_cast<float>(pi)), 0);
    } else {
        const glm::dvec3 place = glm::dvec3(view.to_world[3]) + view.near * forward;
        const double distance = std::max(glm::distance(place, glm::dvec3(bounds.centre())),
                                         static_cast<double>(bounds.radius()));
        const double intensity = std::min(pi * distance * distance, brightest);
        light.position = float4(glm::vec3(place), LIGHT_POINT);
        light.emission = float4(glm::vec3(static_cast<float>(intensity)), 0);
    }
    light.emission.w = power_in(light, bounds);
    const auto own = static_cast<std::ptrdiff_t>(scene.light_names.size());
    scene.lights.insert(scene.lights.begin() + own, light);
    scene.light_names.emplace_back("headlight");
    shift_lights(scene.light_cells, static_cast<std::uint32_t>(own), 1);
}

}  // namespace manylight
