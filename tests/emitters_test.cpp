// SPDX-License-Identifier: MIT
// How emissive triangles become area lights.
#include <algorithm>
#include <array>
#include <glm/gtc/constants.hpp>
#include <random>

#include "support.hpp"

namespace manylight {
namespace {

constexpr glm::vec3 radiance(9, 6, 3);

// A scene of emissive triangles, three corners each, none of them shared.
Scene emitters_of(const std::vector<glm::vec3>& corners, bool both_sides = false) {
    Scene scene;
    scene.vertices = corners;
    for (std::size_t i = 0; i < corners.size(); ++i)
        scene.indices.push_back(static_cast<std::uint32_t>(i));
    scene.triangle_materials.assign(corners.size() / 3, 0);
    Material material{};
    material.emission = float4(radiance, both_sides ? 1 : 0);
    scene.materials = {material};
    add_emitters(scene, 0);
    return scene;
}

LightKind kind_of(const Light& light) { return static_cast<LightKind>(light.position.w); }

std::size_t count_of(const Scene& scene, LightKind kind) {
    return static_cast<std::size_t>(std::ranges::count_if(
        scene.lights, [kind](const Light& light) { return kind_of(light) == kind; }));
}

double power_of(const Scene& scene) {
    double power = 0;
    for (const Light& light : scene.lights) power += light.emission.w;
    return power;
}

// Of the triangles themselves: pi L A.
double expected_power(const Scene& scene) {
    double power = 0;
    for (std::size_t t = 0; t < scene.triangle_count(); ++t) {
        const glm::dvec3 a(scene.vertices[scene.indices[3 * t]]);
        const glm::dvec3 b(scene.vertices[scene.indices[3 * t + 1]]);
        const glm::dvec3 c(scene.vertices[scene.indices[3 * t + 2]]);
        power += glm::length(glm::cross(b - a, c - a)) / 2;
    }
    return power * glm::pi<double>() * luminance(radiance) *
           (scene.materials[0].emission.w != 0 ? 2 : 1);
}

// Whether a light's corners are these four, in any order, to `tolerance` m.
bool has_corners(const Light& light, const std::vector<glm::vec3>& corners, float tolerance) {
    const glm::vec3 corner(light.position);
    const glm::vec3 u(light.axis);
    const glm::vec3 v(light.edge);
    return std::ranges::all_of(corners, [&](const glm::vec3& expected) {
        return std::min({glm::distance(expected, corner), glm::distance(expected, corner + u),
                         glm::distance(expected, corner + v),
                         glm::distance(expected, corner + u + v)}) <= tolerance;
    });
}

// A square of side 0.2, a parallelogram that leans, and one that is long; small enough not to be
// cut.
const std::vector<std::vector<glm::vec3>> parallelograms = {
    {{1, 2, 3}, {1.2f, 2, 3}, {1.2f, 2, 3.2f}, {1, 2, 3.2f}},
    {{1, 2, 3}, {1.1f, 2, 3.05f}, {1.2f, 2.05f, 3.25f}, {1.1f, 2.05f, 3.2f}},
    {{-2, 0.5f, 0}, {-1.75f, 0.5f, 0}, {-1.75f, 0.5f, 0.01f}, {-2, 0.5f, 0.01f}}};

// Corners of both triangles of a parallelogram.
std::vector<glm::vec3> two_triangles(glm::vec3 corner, glm::vec3 u, glm::vec3 v) {
    return {corner, corner + u, corner + u + v, corner, corner + u + v, corner + v};
}

double longest_side(const Light& light) {
    const glm::dvec3 u(light.axis);
    const glm::dvec3 v(light.edge);
    const double sides = std::max(glm::length(u), glm::length(v));
    return kind_of(light) == LIGHT_QUAD ? sides : std::max(sides, glm::length(u - v));
}

// Which light of a plane z = 0 a point is on; fails if it is not one.
int light_at(const Scene& scene, const glm::dvec2& point) {
    int found = -1;
    int count = 0;
    for (std::size_t i = 0; i < scene.lights.size(); ++i) {
        const Light& light = scene.lights[i];
        const glm::dvec2 t =
            glm::inverse(glm::dmat2(glm::dvec2(light.axis), glm::dvec2(light.edge))) *
            (point - glm::dvec2(light.position));
        if (t.x < 0 || t.y < 0) continue;
        if (kind_of(light) == LIGHT_QUAD ? t.x >= 1 || t.y >= 1 : t.x + t.y >= 1) continue;
        found = static_cast<int>(i);
        ++count;
    }
    EXPECT_EQ(count, 1) << point.x << " " << point.y;
    return found;
}

}  // namespace

// Whichever diagonal cuts it, wherever each triangle starts, and whichever is first.
TEST(emitters, two_triangles_of_a_parallelogram_are_one_light) {
    for (const std::vector<glm::vec3>& p : parallelograms)
        for (int variant = 0; variant < 36; ++variant) {
            SCOPED_TRACE(variant);
            const int cut = variant / 18;
            std::array<int, 3> first = {cut, cut + 1, cut + 2};
            std::array<int, 3> second = {cut, cut + 2, (cut + 3) % 4};
            std::rotate(first.begin(), first.begin() + variant % 3, first.end());
            std::rotate(second.begin(), second.begin() + variant / 3 % 3, second.end());
            if (variant / 9 % 2) std::swap(first, second);
            std::vector<glm::vec3> corners;
            for (const auto& triangle : {first, second})
                for (const int i : triangle) corners.push_back(p[i]);
            const Scene scene = emitters_of(corners, variant % 2);
            ASSERT_EQ(scene.lights.size(), 1u);
            const Light& light = scene.lights[0];
            EXPECT_EQ(light.position.w, LIGHT_QUAD);
            EXPECT_TRUE(has_corners(light, p, 1e-6f));
            EXPECT_GT(glm::dot(glm::cross(glm::vec3(light.axis), glm::vec3(light.edge)),
                               glm::cross(p[1] - p[0], p[2] - p[0])),
                      0);
            EXPECT_EQ(light.axis.w, variant % 2);
            EXPECT_EQ(glm::vec3(light.emission), radiance);
            EXPECT_NEAR(light.emission.w, expected_power(scene), 1e-5 * light.emission.w);
        }
}

TEST(emitters, indices_may_be_shared) {
    Scene scene = emitters_of({});
    scene.vertices = parallelograms[0];
    scene.indices = {0, 1, 2, 0, 2, 3};
    scene.triangle_materials = {0, 0};
    add_emitters(scene, 0);
    ASSERT_EQ(scene.lights.size(), 1u);
    EXPECT_TRUE(has_corners(scene.lights[0], parallelograms[0], 1e-6f));
}

// 0 and -0 are the same place.
TEST(emitters, signs_of_zero) {
    const Scene scene = emitters_of({{0, 0, 0},
                                     {0.1f, 0, 0},
                                     {0, 0.1f, -0.f},
                                     {0.1f, -0.f, -0.f},
                                     {0.1f, 0.1f, 0},
                                     {-0.f, 0.1f, 0}});
    EXPECT_EQ(count_of(scene, LIGHT_QUAD), 1u);
}

TEST(emitters, what_makes_no_parallelogram_stays_apart) {
    const glm::vec3 a(0, 0, 0);
    const glm::vec3 b(0.1f, 0, 0);
    const glm::vec3 c(0.1f, 0, 0.1f);
    const glm::vec3 d(0, 0, 0.1f);
    const std::map<std::string, std::vector<glm::vec3>> cases = {
        {"a kite", {a, b, c, a, c, {-0.03f, 0, 0.13f}}},
        {"a folded square", {a, b, c, a, c, {0.01f, 0.01f, 0.09f}}},
        {"a triangle of two", {a, b, c, a, c, {-0.1f, 0, 0}}},
        {"opposite winding", {a, b, c, a, d, c}},
        {"the same triangle twice", {a, b, c, a, b, c}},
        {"both sides of a triangle", {a, b, c, a, c, b}},
        {"one corner in common", {a, b, c, a, d, {-0.05f, 0, 0.05f}}},
        {"off by a thousandth", {a, b, c, a, c, {0, 0, 0.1001f}}},
        {"bent by a thousandth", {a, b, c, a, c, {0, 1e-4f, 0.1f}}}};
    for (const auto& [name, corners] : cases) {
        const Scene scene = emitters_of(corners);
        EXPECT_EQ(scene.lights.size(), 2u) << name;
        EXPECT_EQ(count_of(scene, LIGHT_TRIANGLE), 2u) << name;
        EXPECT_NEAR(power_of(scene), expected_power(scene), 1e-5 * power_of(scene)) << name;
    }
    Scene scene = emitters_of({a, b, c, a, c, d});
    ASSERT_EQ(scene.lights.size(), 1u);
    scene.lights.clear();
    scene.materials.push_back(scene.materials[0]);
    scene.triangle_materials[1] = 1;
    add_emitters(scene, 0);
    EXPECT_EQ(count_of(scene, LIGHT_TRIANGLE), 2u) << "two materials";
}

// Corners that are off by 1e-5 of the sides, and a lamp of 1 cm whose coordinates, 100 m from the
// origin, are rounded to 8e-4 of its sides.
TEST(emitters, coordinates_may_be_rounded) {
    EXPECT_EQ(emitters_of({{0, 0, 0},
                           {0.2f, 0, 0},
                           {0.2f, 0, 0.2f},
                           {0, 0, 0},
                           {0.2f, 0, 0.2f},
                           {2e-6f, 2e-6f, 0.2f}})
                  .lights.size(),
              1u);
    std::mt19937 engine(1);
    std::uniform_real_distribution<float> unit(-1, 1);
    const auto direction = [&] { return glm::vec3(unit(engine), unit(engine), unit(engine)); };
    for (int i = 0; i < 1000; ++i) {
        const glm::dvec3 corner = 100.0 * glm::dvec3(glm::normalize(direction()));
        const glm::dvec3 u = 0.01 * glm::dvec3(glm::normalize(direction()));
        const glm::dvec3 v =
            0.01 * glm::normalize(glm::cross(u, glm::dvec3(glm::normalize(direction()))));
        const Scene scene =
            emitters_of({corner, corner + u, corner + u + v, corner, corner + u + v, corner + v});
        ASSERT_EQ(scene.lights.size(), 1u) << i;
        EXPECT_NEAR(power_of(scene), expected_power(scene), 1e-5 * power_of(scene));
    }
}

// In a grid every two neighbours make a parallelogram: those that make a rectangle are taken,
// whatever the triangles' order.
TEST(emitters, grids_become_rectangles) {
    std::vector<std::array<glm::vec3, 3>> triangles;
    for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 5; ++j) {
            const auto at = [&](int x, int y) {
                return glm::vec3(0.125f * static_cast<float>(i + x), 1,
                                 0.0625f * static_cast<float>(j + y));
            };
            triangles.push_back({at(0, 0), at(1, 1), at(1, 0)});
            triangles.push_back({at(0, 0), at(0, 1), at(1, 1)});
        }
    std::mt19937 engine(1);
    for (int round = 0; round < 20; ++round) {
        std::shuffle(triangles.begin(), triangles.end(), engine);
        std::vector<glm::vec3> corners;
        for (const auto& t : triangles) corners.insert(corners.end(), t.begin(), t.end());
        const Scene scene = emitters_of(corners);
        ASSERT_EQ(scene.lights.size(), 30u);
        for (const Light& light : scene.lights)
            EXPECT_EQ(glm::dot(glm::vec3(light.axis), glm::vec3(light.edge)), 0);
        EXPECT_NEAR(power_of(scene), expected_power(scene), 1e-5 * power_of(scene));
    }
}

// Sides as long as a cell's, rounded, and a little longer; many cells; the most.
TEST(emitters, parallelograms_are_cut_to_cells) {
    struct Case {
        float u, v;
        std::size_t cells;
    };
    for (const auto& [u, v, cells] : {Case{0.25f, 0.01f, 1},
                                      {0.250001f, 0.25f, 1},
                                      {0.26f, 0.25f, 2},
                                      {0.6f, 1.3f, 3 * 6},
                                      {10, 0.01f, 40},
                                      {16, 0.3f, 64 * 2},
                                      {100, 0.3f, 64 * 2},
                                      {400, 20, 64 * 64}}) {
        SCOPED_TRACE(fmt::format("{} x {}", u, v));
        const Scene scene =
            emitters_of(two_triangles({-5, 1, 2}, {0.6f * u, 0, 0.8f * u}, {0, v, 0}));
        EXPECT_EQ(scene.lights.size(), cells);
        EXPECT_EQ(count_of(scene, LIGHT_QUAD), cells);
        EXPECT_NEAR(power_of(scene), expected_power(scene), 1e-5 * power_of(scene));
        for (const Light& light : scene.lights) {
            ASSERT_LE(longest_side(light), std::max(0.25f, std::max(u, v) / 64) * 1.001);
            ASSERT_NEAR(light.emission.w, scene.lights[0].emission.w, 1e-4 * light.emission.w);
            ASSERT_EQ(light.edge.w, scene.lights[0].edge.w);
        }
    }
}

TEST(emitters, triangles_are_cut_to_similar_ones) {
    for (const auto& [size, cells] : {std::pair(0.25f, 1u),
                                      {0.26f, 4u},
                                      {0.5f, 4u},
                                      {0.51f, 16u},
                                      {16.f, 4096u},
                                      {90.f, 4096u}})
        for (int first = 0; first < 3; ++first) {
            SCOPED_TRACE(fmt::format("{} from {}", size, first));
            std::vector<glm::vec3> corners = {
                {0, 0, 0}, {0.4f * size, 0, 0}, {0.6f * size, 0, 0.8f * size}};
            std::rotate(corners.begin(), corners.begin() + first, corners.end());
            const Scene scene = emitters_of(corners, true);
            EXPECT_EQ(scene.lights.size(), cells);
            EXPECT_EQ(count_of(scene, LIGHT_TRIANGLE), cells);
            EXPECT_NEAR(power_of(scene), expected_power(scene), 1e-5 * power_of(scene));
            for (const Light& light : scene.lights) {
                EXPECT_NEAR(longest_side(light), size / std::sqrt(cells), 1e-4 * size);
                ASSERT_EQ(light.axis.w, 1);
                ASSERT_LT(glm::cross(glm::vec3(light.axis), glm::vec3(light.edge)).y, 0);
            }
        }
}

// Every point of the emitters is on one cell, and none beside them.
TEST(emitters, cells_cover_the_emitter) {
    const glm::vec3 u(1.1f, 0.2f, 0);
    const glm::vec3 v(0.3f, 0.7f, 0);
    std::vector<glm::vec3> corners = two_triangles({}, u, v);
    for (const glm::vec3& p : {glm::vec3(0), -v, u}) corners.push_back(p);
    const Scene scene = emitters_of(corners);
    EXPECT_EQ(count_of(scene, LIGHT_QUAD), 5u * 4u);
    EXPECT_EQ(count_of(scene, LIGHT_TRIANGLE), 64u);
    EXPECT_NEAR(power_of(scene), expected_power(scene), 1e-5 * power_of(scene));
    std::mt19937 engine(1);
    std::uniform_real_distribution<float> unit(0.001f, 0.999f);
    std::set<int> met;
    for (int i = 0; i < 10'000; ++i) {
        glm::vec2 t(unit(engine), unit(engine));
        if (i % 2) {
            met.insert(light_at(scene, glm::vec2(t.x * u + t.y * v)));
        } else {
            if (t.x + t.y > 1) t = 1.f - t;
            met.insert(light_at(scene, glm::vec2(t.x * u - t.y * v)));
        }
    }
    EXPECT_EQ(met.size(), 84u);
}

TEST(emitters, triangles_without_extent_give_no_light) {
    EXPECT_EQ(emitters_of({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}}).lights.size(), 0u);
    EXPECT_EQ(emitters_of({{0, 0, 0}, {1, 1, 0}, {2, 2, 0}}).lights.size(), 0u);
    for (const float tiny : {1e-8f, 1e-12f}) {
        const Scene scene = emitters_of({{0, 0, 0}, {tiny, 0, 0}, {0, tiny, 0}});
        ASSERT_EQ(scene.lights.size(), 1u);
        EXPECT_NEAR(power_of(scene) / expected_power(scene), 1, 1e-5);
    }
}

// A square lamp of side 1 whose base colour has a texture of `side` x `side` texels with those
// alphas.
Scene lamp_with_alphas(unsigned side, const std::vector<int>& alphas, float alpha, float cutoff,
                       bool linear = false) {
    Scene scene;
    scene.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    scene.indices = {0, 1, 2, 0, 2, 3};
    scene.triangle_materials = {0, 0};
    scene.coordinates = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
    Material material{};
    material.emission = float4(radiance, 0);
    material.alpha = alpha;
    material.cutoff = cutoff;
    scene.materials = {material};
    Texture texture{};
    texture.width = texture.height = side;
    texture.levels = 1;
    texture.format = TEXELS_LINEAR;
    texture.magnified_linear = linear;
    scene.textures = {texture};
    for (const int a : alphas)
        scene.texels.push_back(0xffffffu | static_cast<std::uint32_t>(a) << 24);
    TextureMap none{};
    none.texture = NO_TEXTURE;
    scene.maps.assign(MAP_KIND_COUNT, none);
    scene.maps[MAP_BASE_COLOR] = {float4(1, 0, 0, 0), float4(0, 1, 0, 0), 0, 0, 1, 0};
    return scene;
}

double lit_share(Scene scene) {
    add_emitters(scene, 0);
    return power_of(scene) / expected_power(scene);
}

// Emitters of which not all is there: what is cut out by a mask gives no light, what is blended as
// much as there is of it.
TEST(emitters, as_much_as_is_there) {
    const std::vector<int> corner = {255, 0, 0, 0};  // a quarter
    EXPECT_NEAR(lit_share(lamp_with_alphas(2, corner, 1, 0)), 1, 1e-5);
    EXPECT_NEAR(lit_share(lamp_with_alphas(2, corner, 1, 0.5f)), 0.25, 1e-5);
    EXPECT_NEAR(lit_share(lamp_with_alphas(2, corner, 1, -1)), 0.25, 1e-5);
    // The material's alpha, by which a mask may be all there or not at all.
    EXPECT_NEAR(lit_share(lamp_with_alphas(2, corner, 0.4f, -1)), 0.1, 1e-5);
    EXPECT_EQ(lit_share(lamp_with_alphas(2, corner, 0.4f, 0.5f)), 0);
    EXPECT_NEAR(lit_share(lamp_with_alphas(1, {255}, 0.4f, -1)), 0.4, 1e-5);
    EXPECT_NEAR(lit_share(lamp_with_alphas(1, {255}, 0.4f, 0.3f)), 1, 1e-5);
    // Interpolated between the columns of texels, half is above a half.
    const double linear = lit_share(lamp_with_alphas(2, {0, 255, 0, 255}, 1, 0.5f, true));
    EXPECT_NEAR(linear, 0.5, 0.01);
    // A fine mask: one in four of 64 x 64 texels.
    std::vector<int> fine(64 * 64);
    for (std::size_t i = 0; i < fine.size(); ++i) fine[i] = i % 2 == 0 && i / 64 % 2 == 0 ? 255 : 0;
    EXPECT_NEAR(lit_share(lamp_with_alphas(64, fine, 1, 0.5f)), 0.25, 0.005);
    // Without texture: the material's, and the vertices'.
    Scene plain = lamp_with_alphas(1, {255}, 0.4f, -1);
    plain.maps.clear();
    EXPECT_NEAR(lit_share(plain), 0.4, 1e-5);
    plain.colors = {float4(1, 1, 1, 1), float4(1, 1, 1, 0), float4(1, 1, 1, 0), float4(1, 1, 1, 1)};
    EXPECT_NEAR(lit_share(plain), 0.2, 1e-3);
    plain.materials[0].cutoff = 0.3f;  // where u < 1/4
    EXPECT_NEAR(lit_share(plain), 0.25, 0.01);
    // As oriented points, too.
    Scene points = lamp_with_alphas(2, corner, 1, 0.5f);
    add_emitters(points, 16);
    EXPECT_NEAR(power_of(points) / expected_power(points), 0.25, 1e-5);
}

// ... and the light comes from there.
TEST(emitters, from_where_something_is) {
    Scene scene = lamp_with_alphas(2, {255, 0, 0, 0}, 1, 0.5f);
    add_emitters(scene, 0);
    EXPECT_EQ(scene.lights.size(), 64u);  // cells of 1/16 m
    for (const Light& light : scene.lights) {
        const float4 centre = light.position + (light.axis + light.edge) / 2.f;
        EXPECT_LT(centre.x, 0.5f);
        EXPECT_LT(centre.y, 0.5f);
        EXPECT_EQ(glm::vec3(light.emission), radiance);
    }
}

// Of each emissive triangle: as many cells as lights, and the lights' areas.
TEST(emitters, areas_of_cells) {
    const glm::vec3 u(1.1f, 0.2f, 0);
    const glm::vec3 v(0.3f, 0.7f, 0);
    std::vector<glm::vec3> corners = two_triangles({}, u, v);
    for (const glm::vec3& p : {glm::vec3(0), -v, u}) corners.push_back(p);
    Scene scene = emitters_of(corners);
    const auto area_of = [](const Scene& s, std::size_t triangle) -> double {
        const LightCells& cells = s.light_cells;
        return cells.grid_of[triangle] == NO_GRID ? 0 : cells.grids[cells.grid_of[triangle]].area;
    };
    ASSERT_EQ(scene.light_cells.grid_of.size(), 3u);
    const double quad = glm::length(glm::cross(u, v)) / 20;
    EXPECT_NEAR(area_of(scene, 0), quad, 1e-6 * quad);
    EXPECT_EQ(area_of(scene, 1), area_of(scene, 0));
    EXPECT_NEAR(area_of(scene, 2), quad * 20 / 128, 1e-6 * quad);
    for (const Light& light : scene.lights) {
        const double area = glm::length(glm::cross(glm::dvec3(light.axis), glm::dvec3(light.edge)));
        if (kind_of(light) == LIGHT_QUAD)
            EXPECT_NEAR(area, area_of(scene, 0), 1e-5 * area);
        else
            EXPECT_NEAR(area / 2, area_of(scene, 2), 1e-5 * area);
    }
    // Triangles that emit nothing have none; points neither.
    scene.materials.push_back({});
    scene.triangle_materials[1] = 1;
    scene.lights.clear();
    add_emitters(scene, 0);
    EXPECT_EQ(area_of(scene, 1), 0);
    EXPECT_GT(area_of(scene, 0), 0);
    Scene points = scene;
    points.light_cells = {};
    add_emitters(points, 10);
    EXPECT_TRUE(points.light_cells.empty());
}

// 400 lamps of 4096 cells each would be more than a million lights: their cells are of 0.5 m.
// A million and one lamps of 0.3 m stay as they are.
TEST(emitters, cells_are_at_most_a_million) {
    std::vector<glm::vec3> corners;
    for (int i = 0; i < 400; ++i)
        for (const glm::vec3& p :
             two_triangles({0, static_cast<float>(i), 0}, {15.9f, 0, 0}, {0, 0, 15.9f}))
            corners.push_back(p);
    Scene scene = emitters_of(corners);
    EXPECT_EQ(scene.lights.size(), 400u * 32 * 32);
    EXPECT_NEAR(power_of(scene), expected_power(scene), 1e-5 * power_of(scene));
    corners.clear();
    for (int i = 0; i < 1'000'001; ++i) {
        const glm::vec3 p(static_cast<float>(i % 1000), static_cast<float>(i / 1000), 0);
        for (const glm::vec3& q : {p, p + glm::vec3(0.3f, 0, 0), p + glm::vec3(0, 0.3f, 0)})
            corners.push_back(q);
    }
    scene = emitters_of(corners);
    EXPECT_EQ(scene.lights.size(), 1'000'001u);
}

// Lights are in the order of their triangles; of three, one stays alone.
TEST(emitters, the_rest_stay_triangles) {
    const std::vector<glm::vec3>& p = parallelograms[0];
    const Scene scene =
        emitters_of({p[0], p[1], p[2], {5, 0, 0}, {5.1f, 0, 0}, {5, 0.1f, 0}, p[0], p[2], p[3]});
    ASSERT_EQ(scene.lights.size(), 2u);
    EXPECT_EQ(scene.lights[0].position.w, LIGHT_QUAD);
    EXPECT_EQ(scene.lights[1].position.w, LIGHT_TRIANGLE);
    EXPECT_EQ(glm::vec3(scene.lights[1].position), glm::vec3(5, 0, 0));
}

}  // namespace manylight
