// SPDX-License-Identifier: MIT
#include "explain/top_lights.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <unordered_map>

#include "reference/gbuffer.hpp"
#include "reference/random.hpp"
#include "reference/samplers/lighttree.hpp"
#include "stages/tiles.hpp"

namespace manylight {
namespace {

constexpr unsigned most_points = 4096;
constexpr unsigned samples = 16;
constexpr uint dimension = 0xfffffff0u;  // of random numbers, apart from those of the samplers

// A point of each of a grid of equal rectangles, as square as may be.
std::vector<glm::dvec2> stratified_points(unsigned width, unsigned height, unsigned most,
                                          uint seed) {
    const double scale =
        std::sqrt(std::min(1.0, most / (static_cast<double>(width) * static_cast<double>(height))));
    const auto columns = std::max(1u, static_cast<unsigned>(width * scale));
    const auto rows = std::max(1u, std::min(static_cast<unsigned>(height * scale), most / columns));
    std::vector<glm::dvec2> points;
    for (unsigned y = 0; y < rows; ++y)
        for (unsigned x = 0; x < columns; ++x) {
            const auto bits = reference::random_bits(y * columns + x, 0, dimension, seed);
            points.emplace_back((x + reference::unit_fraction(bits[0])) * width / columns,
                                (y + reference::unit_fraction(bits[1])) * height / rows);
        }
    return points;
}

// What lights give at the image's points.
class Points {
  public:
    Points(const Scene& scene, const Camera& camera, unsigned width, unsigned height, uint seed,
           unsigned most = most_points)
        : scene_(scene.varies_materials() ? varied_.emplace(scene) : scene),
          camera_(camera),
          tracer_(scene_),
          seed_(seed) {
        const Tiles tiles = all_tiles(width, height, 32);
        for (const glm::dvec2& at : stratified_points(width, height, most, seed)) {
            const reference::Ray ray = reference::primary_ray(camera, tiles, at);
            const auto hit = tracer_.closest_hit(ray);
            surfaces_.push_back(reference::surface_at(scene_, ray, hit));
            if (varied_) reference::own_material(*varied_, ray, hit, surfaces_.back());
        }
    }

    [[nodiscard]] std::size_t size() const { return surfaces_.size(); }
    [[nodiscard]] std::size_t rays() const { return rays_; }
    [[nodiscard]] const Surface& surface(std::size_t p) const { return surfaces_[p]; }
    [[nodiscard]] const Camera& camera() const { return camera_; }

    [[nodiscard]] std::array<uint, 4> random(std::size_t p, uint number) const {
        return reference::random_bits(static_cast<uint>(p), number, dimension + 1, seed_);
    }

    // Luminance that a point of a light gives at point p of the image, cd/m2.
    [[nodiscard]] double luminance(std::size_t p, std::size_t light, const glm::dvec2& u) {
        const Surface& s = surfaces_[p];
        const reference::Unshadowed term =
            reference::unshadowed(s, scene_.materials[s.shading], camera_, scene_.lights[light], u);
        if (term.value == glm::dvec3(0)) return 0;
        ++rays_;
        return tracer_.occluded(term.shadow) ? 0 : reference::luminance(term.value);
    }

    // The segment from point p to a light's middle, if its light falls on that side of a white
    // surface: the one that is seen, or the other.
    [[nodiscard]] std::optional<reference::Ray> way(std::size_t p, std::size_t light,
                                                    bool behind) const {
        Surface s = surfaces_[p];
        if (behind) {
            s.normal = -s.normal;
            s.horizon = {-glm::vec3(s.horizon), s.horizon.w};
        }
        Material white{};
        white.base_color = {1, 1, 1, 0};
        white.roughness = 1;
        const reference::Unshadowed term =
            reference::unshadowed(s, white, camera_, scene_.lights[light], glm::dvec2(0.4));
        if (term.value == glm::dvec3(0)) return {};
        return term.shadow;
    }

    [[nodiscard]] std::optional<reference::Hit> blocker(const reference::Ray& way) const {
        return tracer_.closest_hit(way);
    }

    // With the points' own materials.
    [[nodiscard]] const Scene& scene() const { return scene_; }

  private:
    std::optional<Scene> varied_;  // a copy, to which the points' materials are added
    const Scene& scene_;
    const Camera& camera_;
    reference::Tracer tracer_;
    uint seed_;
    std::vector<Surface> surfaces_;
    std::size_t rays_ = 0;
};

glm::dvec2 on_light(const std::array<uint, 4>& bits) {
    return {reference::unit_fraction(bits[1]), reference::unit_fraction(bits[2])};
}

// [point] what all lights give there, estimated from draws, and [light] what those drawn give in
// all.
std::pair<std::vector<double>, std::unordered_map<uint, double>> draw(Points& points,
                                                                      const Scene& scene) {
    const LightTree tree = build_light_tree(scene.lights);
    const reference::DownLightTree sampler(tree);
    std::vector<double> totals(points.size(), 0);
    std::unordered_map<uint, double> by_light;
    for (std::size_t p = 0; p < points.size(); ++p) {
        if (points.surface(p).position.w < 0) continue;
        for (uint i = 0; i < samples; ++i) {
            const auto bits = points.random(p, i);
            const reference::Choice choice =
                sampler.choose({points.scene(), points.camera(), points.surface(p)},
                               {p, i, samples, bits, static_cast<uint>(scene.lights.size())});
            if (choice.weight == 0) continue;
            const double value = choice.weight * points.luminance(p, choice.light, on_light(bits));
            totals[p] += value;
            if (value > 0) by_light[choice.light] += value;
        }
    }
    return {std::move(totals), std::move(by_light)};
}

// The first `count` lights by what they give.
std::vector<uint> largest(const std::unordered_map<uint, double>& by_light, std::size_t count) {
    std::vector<std::pair<double, uint>> all;
    for (const auto& [light, value] : by_light) all.emplace_back(-value, light);
    std::ranges::sort(all);
    std::vector<uint> out;
    for (std::size_t i = 0; i < std::min(count, all.size()); ++i) out.push_back(all[i].second);
    return out;
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

}  // namespace

TopLights find_top_lights(const Scene& scene, const Camera& camera, unsigned width, unsigned height,
                          unsigned count, unsigned seed) {
    Points points(scene, camera, width, height, seed);
    TopLights out;
    out.points = static_cast<unsigned>(points.size());
    const auto n = static_cast<double>(points.size());
    std::vector<uint> candidates;
    std::vector<double> totals(points.size(), 0);
    if (scene.lights.size() > 2 * std::size_t{count}) {
        out.light_samples = samples;
        std::unordered_map<uint, double> by_light;
        std::tie(totals, by_light) = draw(points, scene);
        candidates = largest(by_light, 2 * std::size_t{count});
    } else {
        candidates.resize(scene.lights.size());
        std::iota(candidates.begin(), candidates.end(), 0u);
    }
    std::vector<std::vector<double>> values;  // [candidate][point]
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        std::vector<double>& own = values.emplace_back(points.size(), 0);
        for (std::size_t p = 0; p < points.size(); ++p) {
            if (points.surface(p).position.w < 0) continue;
            const auto bits = points.random(p, samples + static_cast<uint>(i));
            own[p] = points.luminance(p, candidates[i], on_light(bits));
            if (out.light_samples == 0) totals[p] += own[p];
        }
    }
    out.shadow_rays = points.rays();
    const double total = std::accumulate(totals.begin(), totals.end(), 0.0);
    out.luminance = total / n;
    for (std::size_t i = 0; i < candidates.size() && total > 0; ++i) {
        const std::vector<double>& own = values[i];
        const double share = std::accumulate(own.begin(), own.end(), 0.0) / total;
        // Of a ratio of means: the deviations of own - share x total.
        const double squares =
            dot(own, own) - 2 * share * dot(own, totals) + share * share * dot(totals, totals);
        const auto lit = std::ranges::count_if(own, [](double v) { return v > 0; });
        out.lights.push_back({candidates[i], share, std::sqrt(std::max(squares, 0.0)) / total,
                              static_cast<double>(lit) / n});
    }
    std::ranges::stable_sort(out.lights, std::greater(), &TopLight::share);
    if (out.lights.size() > count) out.lights.resize(count);
    return out;
}

std::string why_black(const Scene& scene, const Camera& camera, unsigned width, unsigned height,
                      bool hides_emitters) {
    if (scene.seen_triangle_count() == 0) return "the scene has no triangles";
    constexpr unsigned looked_at = 256;
    constexpr std::size_t lights_asked = 64;
    Points points(scene, camera, width, height, 0, looked_at);
    std::vector<std::size_t> hits;
    for (std::size_t p = 0; p < points.size(); ++p)
        if (points.surface(p).position.w >= 0) hits.push_back(p);
    if (hits.empty()) return "no geometry is in view: the camera looks past all of it";
    const auto shines = [&](std::size_t p) {
        const Material& material = points.scene().materials[points.surface(p).shading];
        return glm::vec3(material.emission) != glm::vec3(0);
    };
    if (hides_emitters && std::ranges::all_of(hits, shines))
        return "all that is in view shines, and --hide-emitters shows that black";
    if (scene.lights.empty()) return "the scene has no lights, and nothing in view shines";
    std::size_t lit = 0, free = 0, blocked = 0, behind = 0;
    std::map<std::string, std::size_t> blockers;
    const std::size_t step = (scene.lights.size() + lights_asked - 1) / lights_asked;
    for (const std::size_t p : hits)
        for (std::size_t light = 0; light < scene.lights.size(); light += step) {
            const auto way = points.way(p, light, false);
            if (!way) {
                behind += points.way(p, light, true) ? 1 : 0;
                continue;
            }
            const auto hit = points.blocker(*way);
            (hit ? blocked : free) += 1;
            if (hit && hit->triangle < scene.triangle_count())
                ++blockers[scene.material_names[scene.triangle_materials[hit->triangle]]];
            lit += points.luminance(p, light, glm::dvec2(0.4)) > 0 ? 1 : 0;
        }
    if (lit > 0)
        return "light does reach what is in view, but no sample found it: take more, or another "
               "--sampler";
    if (free > 0) return "light reaches what is in view, which reflects none: it is black";
    if (blocked == 0 && behind == 0)
        return "no light reaches what is in view: lights are out of range, outside their cones, or "
               "shine the other way";
    if (behind > blocked)
        return "all lights are behind the surfaces in view, of which the dark side is seen, as "
               "from below a floor";
    const auto most =
        std::ranges::max_element(blockers, {}, [](const auto& blocker) { return blocker.second; });
    return fmt::format("other surfaces block all light on its way to what is in view{}",
                       most == blockers.end() || most->first.empty()
                           ? ""
                           : fmt::format(", most of it those of material '{}'", most->first));
}

}  // namespace manylight
