// SPDX-License-Identifier: MIT
// Sampler octree: its tree, its bounds, and its limits.
#include "samplers/octree/octree.hpp"

#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <random>

#include "output/metrics.hpp"
#include "reference/gbuffer.hpp"
#include "reference/samplers/octree.hpp"
#include "samplers/octree/build_octree.hpp"
#include "support.hpp"

namespace manylight {
namespace {

class Random {
  public:
    explicit Random(unsigned seed) : bits_(seed) {}
    double operator()(double least, double most) {
        return std::uniform_real_distribution<double>(least, most)(bits_);
    }
    bool chance(double probability) { return (*this)(0, 1) < probability; }
    int below(int count) { return std::uniform_int_distribution<int>(0, count - 1)(bits_); }
    glm::dvec3 direction() {
        while (true) {
            const glm::dvec3 v((*this)(-1, 1), (*this)(-1, 1), (*this)(-1, 1));
            if (glm::dot(v, v) > 0.01 && glm::dot(v, v) < 1) return glm::normalize(v);
        }
    }

  private:
    std::mt19937 bits_;
};

bool has_area(int kind) { return kind == LIGHT_TRIANGLE || kind == LIGHT_QUAD; }

Light make_light(Random& random, int kind, const glm::dvec3& position, const glm::dvec3& axis,
                 double size) {
    Light light{};
    light.position = float4(glm::vec3(position), static_cast<float>(kind));
    light.axis = float4(glm::vec3(axis), 0);
    light.emission = float4(random(0.1, 1), random(0.1, 1), random(0.1, 1), 1);
    if ((kind == LIGHT_POINT || kind == LIGHT_SPOT) && random.chance(0.3))
        light.axis.w = static_cast<float>(random(1, 20) * size);
    if (kind == LIGHT_SPOT) {
        light.edge.y = static_cast<float>(random(0.01, 1));
        light.edge.x = static_cast<float>(1 / (light.edge.y * random(0.05, 1)));
    }
    if (!has_area(kind)) return light;
    const glm::dvec3 side = size * glm::normalize(glm::cross(axis, random.direction()));
    light.axis = float4(glm::vec3(side), random.chance(0.4) ? 1 : 0);
    light.edge = float4(glm::vec3(glm::cross(axis, side) * random(0.1, 1)), 0);
    return light;
}

// Some lights near one place that face much the same way, of one kind or, `mixed`, of many.
std::vector<Light> make_lights(Random& random, bool mixed) {
    const std::array kinds = {LIGHT_POINT, LIGHT_SPOT, LIGHT_ORIENTED, LIGHT_TRIANGLE, LIGHT_QUAD};
    const int own = kinds[random.below(5)];
    const glm::dvec3 axis = random.direction();
    const double spread = std::pow(10, random(-3, 0.5));
    std::vector<Light> lights;
    for (int i = 2 + random.below(8); i > 0; --i) {
        const int kind = mixed ? kinds[random.below(5)] : own;
        const glm::dvec3 place(random(-1, 1), random(-1, 1), random(-1, 1));
        lights.push_back(make_light(random, kind, place,
                                    glm::normalize(axis + spread * random.direction()), 0.3));
    }
    return lights;
}

double area_of(const Light& light) {
    const int kind = static_cast<int>(light.position.w);
    if (!has_area(kind)) return 1;
    const double whole = glm::length(glm::cross(glm::dvec3(light.axis), glm::dvec3(light.edge)));
    return kind == LIGHT_QUAD ? whole : whole / 2;
}

// Of a node: the lights of the leaves below it.
std::vector<uint> lights_of(const std::vector<OctreeNode>& nodes, uint node) {
    std::vector<uint> out;
    for (uint i = node; i < nodes[node].next; ++i)
        if (nodes[i].next == i + 1) out.push_back(nodes[i].light);
    return out;
}

Material make_material(Random& random) {
    Material m{};
    m.base_color = float4(random(0, 1), random(0, 1), random(0, 1), 0);
    m.reflectance = float4(0.04f, 0.04f, 0.04f, 0);
    m.roughness = 1;
    if (random.chance(0.3)) return m;
    m.roughness = static_cast<float>(std::pow(10, random(-2, 0)));
    m.specular = static_cast<float>(random(0, 1));
    m.base_color.w = random.chance(0.5) ? 1.f : static_cast<float>(random(0, 1));
    return m;
}

// A receiver of a node, and who looks at it: anywhere, near its horizon, where the lights are
// mirrored, or opposite to the lights.
Surface make_receiver(Random& random, const OctreeNode& node, Camera& camera) {
    const double distance = double{node.centre.w} * std::pow(10, random(-0.5, 2.5));
    const glm::dvec3 towards = random.direction();
    const glm::dvec3 position = glm::dvec3(node.centre) - distance * towards;
    glm::dvec3 normal = random.direction();
    if (random.chance(0.3))  // the lights on its horizon, or a little above or below
        normal = glm::normalize(glm::cross(towards, normal) + random(-0.1, 0.1) * towards);
    if (glm::dot(normal, towards) < -0.1) normal = -normal;
    glm::dvec3 to_camera = random.direction();
    if (random.chance(0.3)) to_camera = glm::reflect(-towards, normal);
    if (random.chance(0.2)) to_camera = -towards + 0.05 * random.direction();
    if (glm::dot(to_camera, normal) < 0) to_camera = glm::reflect(to_camera, normal);
    Surface surface{};
    surface.position = float4(glm::vec3(position), 1);
    surface.normal = float4(glm::vec3(normal), 0);
    surface.horizon = surface.normal;
    if (random.chance(0.2))
        surface.horizon = float4(glm::vec3(glm::normalize(normal + 0.2 * random.direction())), 0);
    camera = {};
    camera.origin =
        float4(surface.position + float4(glm::vec3(10.0 * glm::normalize(to_camera)), 0));
    return surface;
}

struct Counts {
    int pairs = 0, dark = 0, inside = 0, alike = 0;
};

// Every light of an inner node, at some of its points, against the node's bounds.
void check_bounds(Random& random, const reference::Point& point,
                  const std::vector<OctreeNode>& nodes, Counts& counts) {
    const reference::NodeBounds bounds = reference::bound_node(nodes[0], point);
    ++counts.pairs;
    counts.dark += bounds.most == glm::dvec3(0) ? 1 : 0;
    counts.inside += std::isinf(bounds.most.r) ? 1 : 0;
    bool alike = bounds.most.r > 0;
    for (int c = 0; c < 3; ++c)
        alike = alike && bounds.most[c] <= 1.5 * bounds.estimate[c] &&
                bounds.least[c] >= 0.5 * bounds.estimate[c];
    counts.alike += alike ? 1 : 0;
    for (const uint index : lights_of(nodes, 0)) {
        const Light& light = point.scene.lights[index];
        const glm::dvec3 intensity = area_of(light) * glm::dvec3(light.emission);
        for (int k = 0; k < 2; ++k) {
            const glm::dvec3 found =
                reference::unshadowed(point.surface, point.material(), point.viewer, light,
                                      {random(0, 1), random(0, 1)})
                    .value /
                intensity;
            for (int c = 0; c < 3; ++c) {
                ASSERT_LE(found[c], bounds.most[c] * (1 + 1e-6) + 1e-12)
                    << "kind " << light.position.w << ", pair " << counts.pairs;
                ASSERT_GE(found[c], bounds.least[c] * (1 - 1e-6) - 1e-12)
                    << "kind " << light.position.w << ", pair " << counts.pairs;
            }
        }
    }
}

// A floor under white lights of different power, with nothing in between.
test::TestScene open_scene() {
    return test::make_scene(
        [](GltfWriter& out) {
            Mesh plane;
            plane.add_quad({-5, 0, 5}, {10, 0, 0}, {0, 0, -10});
            out.add_mesh("plane", plane, out.add_material({0.5f, 0.6f, 0.7f}, 0, 0.7f));
            for (int i = 0; i < 400; ++i) {
                const auto k = static_cast<float>(i);
                out.add_point(
                    {3 * std::sin(5 * k), 2 + 0.8f * std::sin(3 * k), 3 * std::cos(7 * k)},
                    glm::vec3(0.1f + 0.002f * k));
            }
            out.add_camera("front", {0, 3, 4}, {0, 0, 0}, 0.8f, 1);
        },
        20, 12);
}

}  // namespace

// Nodes are consecutive, and hold what they say of their lights.
TEST(octree, holds_every_light_once) {
    Random random(3);
    std::vector<Light> lights;
    for (int i = 0; i < 300; ++i)
        for (const Light& light : make_lights(random, true)) lights.push_back(light);
    for (int i = 0; i < 50; ++i) lights.push_back(lights[7]);  // at one place, facing one way
    for (int i = 0; i < 5; ++i) lights[10 * i].emission = float4(0);
    for (int i = 0; i < 2; ++i)
        lights.push_back(make_light(random, LIGHT_DIRECTIONAL, {}, random.direction(), 1));
    const std::vector<OctreeNode> nodes = build_octree(lights);
    std::vector<int> found(lights.size());
    double children = 0, inner = 0;
    for (uint i = 0; i < nodes.size(); ++i) {
        const OctreeNode& node = nodes[i];
        ASSERT_GT(node.next, i);
        ASSERT_LE(node.next, nodes.size());
        const std::vector<uint> own = lights_of(nodes, i);
        ASSERT_EQ(own.size(), node.count);
        EXPECT_EQ(own[0], node.light);
        if (node.count == 1) ++found[node.light];
        if (node.count == 1) continue;
        int count = 0;
        for (uint child = i + 1; child < node.next; child = nodes[child].next) ++count;
        EXPECT_GE(count, 2);
        EXPECT_LE(count, 8);
        children += count;
        ++inner;
        glm::dvec3 intensity(0);
        for (const uint light : own)
            intensity += area_of(lights[light]) * glm::dvec3(lights[light].emission);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(node.intensity[c], intensity[c], 1e-5 * intensity[c]);
    }
    for (std::size_t i = 0; i < lights.size(); ++i)
        EXPECT_EQ(found[i], lights[i].emission.x > 0 ? 1 : 0) << i;
    EXPECT_GT(children / inner, 2.2);
    EXPECT_EQ(nodes[0].count, 1u);  // the directional ones
    EXPECT_EQ(nodes[1].count, 1u);
    EXPECT_EQ(nodes[2].next, nodes.size());
    EXPECT_EQ(build_octree(std::vector<Light>(3)).size(), 1u);  // of lights that do not shine
}

// 100,000 pairs of a node and a receiver: inside its radius, grazing, in the mirror direction, and
// looked at along the light.
TEST(octree, bounds_hold) {
    Random random(11);
    Counts counts;
    for (int i = 0; i < 5'000; ++i) {
        Scene scene;
        scene.lights = make_lights(random, i % 5 == 0);
        const std::vector<OctreeNode> nodes = build_octree(scene.lights);
        for (int k = 0; k < 20; ++k) {
            scene.materials = {make_material(random)};
            Camera camera;
            const Surface surface = make_receiver(random, nodes[0], camera);
            check_bounds(random, {scene, camera, surface}, nodes, counts);
            if (testing::Test::HasFatalFailure()) return;
        }
    }
    EXPECT_GT(counts.inside, 1'000);
    EXPECT_GT(counts.dark, 1'000);
    EXPECT_GT(counts.alike, 4'000);
}

// Where every light is a node of its own, the images are those of sampler exhaustive, random points
// of area lights included.
TEST(octree, without_error_it_is_exhaustive) {
    FOR_EACH_DEVICE(device)
    for (const std::string& name : test::scene_names())
        for (const char* sampler : {"octree", "octree-virtual"}) {
            SCOPED_TRACE(fmt::format("{} on {}", sampler, name));
            const test::TestScene& scene = test::scene_named(name);
            RenderOptions options;
            options.spp = 2;
            options.sampler = "exhaustive";
            const FrameResult expected = test::render(device, scene, options);
            options.sampler = sampler;
            options.parameters["epsilon"] = 0;
            const FrameResult found = test::render(device, scene, options);
            EXPECT_LT(compare_images(found.image, expected.image, "octree", "exhaustive").relmse,
                      1e-11);
            EXPECT_EQ(found.shadow_rays, expected.shadow_rays);
        }
}

// Where nothing is in between, each node of a cut errs by no more than epsilon of the whole, and so
// does each of its lights in place of all of them.
TEST(octree, nodes_of_a_cut_keep_the_bound) {
    const test::TestScene s = open_scene();
    const std::vector<OctreeNode> nodes = build_octree(s.scene.lights);
    const Tiles tiles = all_tiles(s.width, s.height, 16);
    const reference::Tracer tracer(s.scene);
    std::size_t size = s.scene.lights.size();
    for (const double epsilon : {0.001, 0.01, 0.1}) {
        const reference::Octree octree(nodes, epsilon, true);
        std::size_t largest = 0;
        for (uint x = 0; x < s.width; ++x) {
            const Surface surface =
                reference::gbuffer(s.scene, tracer, s.camera, tiles, x, s.height - 1, false, 0, 0);
            ASSERT_GE(surface.position.w, 0);
            const reference::Point point{s.scene, s.camera, surface};
            const glm::dvec3 error = epsilon * octree.total(point) * (1 + 1e-6);
            const std::vector<uint> cut = octree.cut(point);
            largest = std::max(largest, cut.size());
            std::size_t held = 0;
            for (const uint node : cut) {
                held += nodes[node].count;
                if (nodes[node].count == 1) continue;
                const glm::dvec3 intensity(nodes[node].intensity);
                const glm::dvec3 estimate =
                    intensity * reference::bound_node(nodes[node], point).estimate;
                glm::dvec3 sum(0);
                for (const uint light : lights_of(nodes, node)) {
                    const glm::dvec3 one =
                        reference::unshadowed(surface, point.material(), s.camera,
                                              s.scene.lights[light], glm::dvec2(0))
                            .value;
                    const glm::dvec3 emission(s.scene.lights[light].emission);
                    sum += one;
                    for (int c = 0; c < 3; ++c)
                        EXPECT_LE(std::abs(one[c] / emission[c] * intensity[c] - estimate[c]),
                                  error[c]);
                }
                for (int c = 0; c < 3; ++c) EXPECT_LE(std::abs(sum[c] - estimate[c]), error[c]);
            }
            EXPECT_EQ(held, s.scene.lights.size());
        }
        EXPECT_LT(largest, size);
        size = largest;
    }
    EXPECT_LT(size, s.scene.lights.size() / 4);
}

// Where nothing is in between, virtual lights are the nearer to all lights, and the more, the less
// epsilon is; and so is one light of each node.
TEST(octree, errors_fall_with_epsilon) {
    const test::TestScene scene = open_scene();
    FOR_EACH_DEVICE(device) {
        RenderOptions options;
        options.spp = 1;
        options.sampler = "exhaustive";
        const FrameResult exact = test::render(device, scene, options);
        for (const char* sampler : {"octree", "octree-virtual"}) {
            SCOPED_TRACE(sampler);
            options.sampler = sampler;
            std::size_t rays = exact.shadow_rays;
            double error = 0;
            for (const double epsilon : {0.003, 0.03, 0.3}) {
                options.parameters["epsilon"] = epsilon;
                const FrameResult found = test::render(device, scene, options);
                const double next =
                    compare_images(found.image, exact.image, sampler, "exhaustive").relmse;
                EXPECT_GT(next, 2 * error);
                const double nodes =
                    static_cast<double>(found.shadow_rays) / (scene.width * scene.height);
                EXPECT_LT(next, nodes * epsilon * epsilon);  // of errors that do not conspire
                EXPECT_LT(found.shadow_rays, rays);
                error = next;
                rays = found.shadow_rays;
            }
            EXPECT_GT(error, 1e-7);
        }
    }
}

}  // namespace manylight
