// SPDX-License-Identifier: MIT
#include <glm/gtc/matrix_transform.hpp>
#include <random>

#include "reference/gbuffer.hpp"
#include "reference/tiles.hpp"
#include "support.hpp"

namespace manylight {
namespace {

// Triangles of all sizes, some without area and some twice.
Scene random_soup(std::size_t triangles) {
    std::mt19937 engine(4);
    std::uniform_real_distribution<float> unit(-1, 1);
    Scene scene;
    scene.file = "soup";
    scene.materials.push_back({});
    scene.materials[0].base_color = float4(0.5f, 0.5f, 0.5f, 0);
    scene.materials[0].roughness = 1;
    for (std::size_t t = 0; t < triangles; ++t) {
        const glm::vec3 centre(unit(engine), unit(engine), unit(engine));
        const float size = std::pow(10.0f, -2 + 1.5f * std::abs(unit(engine)));
        glm::vec3 v[3];
        for (glm::vec3& p : v)
            p = centre + size * glm::vec3(unit(engine), unit(engine), unit(engine));
        if (t % 17 == 0) v[2] = v[1];
        for (int copy = 0; copy < (t % 23 == 0 ? 2 : 1); ++copy) {
            for (const glm::vec3 p : v) {
                scene.indices.push_back(static_cast<std::uint32_t>(scene.vertices.size()));
                scene.vertices.push_back(p);
            }
            scene.triangle_materials.push_back(0);
        }
    }
    return scene;
}

Camera camera_at(glm::vec3 eye) {
    Scene scene;
    View view;
    view.half_height = 0.5;
    view.to_world[3] = glm::dvec4(eye, 1);
    return make_camera(view, 64, 64);
}

std::vector<Surface> trace(Device device, const Scene& scene, const Camera& camera, unsigned lanes,
                           const Tiles& tiles) {
    const WideBvh bvh = build_wide_bvh(scene, lanes, lanes, reach_of(scene, camera));
    const DeviceScene uploaded = upload_scene(device, scene, bvh, camera);
    Buffer<Surface> surfaces = device.allocate<Surface>(item_count(tiles));
    GBufferStage(device, uploaded).trace(tiles, {}, surfaces);
    return surfaces.download();
}

}  // namespace

TEST(gbuffer, agrees_with_the_reference) {
    FOR_EACH_DEVICE(device)
    for (const std::string& scene : test::scene_names()) {
        SCOPED_TRACE(scene);
        test::expect_stage("gbuffer", test::verifier(scene, device));
    }
}

// The reference's own tree against testing every triangle.
TEST(gbuffer, reference_tree_finds_the_closest_of_all) {
    const Scene scene = random_soup(600);
    const reference::Tracer tracer(scene);
    const Tiles tiles = all_tiles(64, 64, 32);
    int hits = 0;
    for (uint y = 0; y < 64; ++y)
        for (uint x = 0; x < 64; ++x) {
            const reference::Ray ray =
                reference::primary_ray(camera_at({0, 0, 3}), tiles, {x + 0.5, y + 0.5});
            const auto found = tracer.closest_hit(ray);
            const auto expected = tracer.closest_hit_of_all(ray);
            ASSERT_EQ(found.has_value(), expected.has_value());
            if (!found) continue;
            ++hits;
            ASSERT_EQ(found->t, expected->t);
        }
    EXPECT_GT(hits, 500);
}

// Every width of node, from inside and outside a soup.
TEST(gbuffer, hits_of_a_soup_at_every_width) {
    const Scene scene = random_soup(3000);
    const reference::Tracer tracer(scene);
    const Tiles tiles = all_tiles(64, 64, 32);
    FOR_EACH_DEVICE(device)
    for (const unsigned lanes : {4u, 8u, 16u})
        for (const glm::vec3 eye : {glm::vec3(0, 0, 3), glm::vec3(0.1f, -0.2f, 0.3f)}) {
            const Camera camera = camera_at(eye);
            const std::vector<Surface> found = trace(device, scene, camera, lanes, tiles);
            int differences = 0;
            reference::for_each_pixel(tiles, [&](uint x, uint y, std::size_t item) {
                const auto hit =
                    tracer.closest_hit(reference::primary_ray(camera, tiles, {x + 0.5, y + 0.5}));
                const double t = hit ? hit->t : -1;
                if (std::abs(found[item].position.w - t) > 1e-4) ++differences;
            });
            EXPECT_LE(differences, 3) << lanes << " lanes";  // pixels whose ray grazes an edge
        }
}

TEST(gbuffer, empty_scene_is_missed) {
    Scene scene;
    const Tiles tiles = all_tiles(20, 10, 32);
    FOR_EACH_DEVICE(device) {
        const std::vector<Surface> found = trace(device, scene, camera_at({0, 0, 3}), 8, tiles);
        reference::for_each_pixel(
            tiles, [&](uint, uint, std::size_t item) { EXPECT_LT(found[item].position.w, 0); });
    }
}

// Rays aimed exactly at shared edges and vertices of a closed box, from its centre: none leaks.
TEST(gbuffer, closed_mesh_is_watertight) {
    const test::TestScene box = test::make_scene([](GltfWriter& out) {
        Mesh mesh;  // a crooked box whose triangles share their vertices
        for (int i = 0; i < 8; ++i)
            mesh.positions.push_back({(i & 1 ? 1.0f : -0.8f) + 0.13f * (i & 2),
                                      (i & 2 ? 0.7f : -0.6f),
                                      (i & 4 ? 1.1f : -0.9f) + 0.07f * (i & 3)});
        mesh.indices = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                        2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
        out.add_mesh("box", mesh, out.add_diffuse(glm::vec3(0.5f)));
    });
    const Tiles tiles = all_tiles(64, 64, 32);
    FOR_EACH_DEVICE(device)
    for (std::size_t edge = 0; edge < box.scene.indices.size(); ++edge) {
        // Orthographic, towards a point of an edge, with the image along it: its rays lie on it.
        const std::size_t next = edge % 3 == 2 ? edge - 2 : edge + 1;
        const glm::vec3 a = box.scene.vertices[box.scene.indices[edge]];
        const glm::vec3 b = box.scene.vertices[box.scene.indices[next]];
        const glm::vec3 eye(0.1f, -0.05f, 0.2f);
        const glm::vec3 forward =
            glm::normalize(glm::mix(a, b, static_cast<float>(edge % 9) / 8) - eye);
        const glm::vec3 right = 0.05f * glm::normalize(b - a);
        const Camera camera{float4(eye, 0), float4(right, 0),
                            float4(1e-4f * glm::cross(forward, right), 0), float4(forward, 1)};
        for (const Surface& s : trace(device, box.scene, camera, 16, tiles))
            ASSERT_GE(s.position.w, 0) << "edge " << edge;
    }
}

// A ray of NaNs, as overflow may make one, ends and hits nothing.
TEST(gbuffer, rays_that_are_no_numbers_end) {
    const Tiles tiles = all_tiles(16, 16, 16);
    const float4 nan(std::numeric_limits<float>::quiet_NaN());
    const Camera camera{nan, nan, nan, nan};
    FOR_EACH_DEVICE(device)
    for (const Surface& s : trace(device, random_soup(500), camera, 16, tiles))
        EXPECT_FALSE(s.position.w >= 0);
}

// Between the planes of a camera that looks askew, and no others.
TEST(gbuffer, cameras_clip_what_they_see) {
    const Scene scene = random_soup(3000);
    const reference::Tracer tracer(scene);
    const Tiles tiles = all_tiles(64, 64, 32);
    View view;
    view.half_height = 0.5;
    view.near = 2.6;
    view.far = 3.3;
    view.to_world = glm::rotate(glm::dmat4(1), 0.4, glm::dvec3(0.3, 1, 0.1));
    view.to_world[3] = 3.0 * view.to_world[2] + glm::dvec4(0, 0, 0, 1);
    FOR_EACH_DEVICE(device)
    for (const bool orthographic : {false, true}) {
        view.orthographic = orthographic;
        if (orthographic) view.half_height = 1;
        const Camera camera = make_camera(view, 64, 64, {7, -3});
        const std::vector<Surface> found = trace(device, scene, camera, 8, tiles);
        int differences = 0;
        int hits = 0;
        int clipped = 0;
        reference::for_each_pixel(tiles, [&](uint x, uint y, std::size_t item) {
            reference::Ray ray = reference::primary_ray(camera, tiles, {x + 0.5, y + 0.5});
            const auto depth = [&](double t) {
                return -glm::dot(ray.origin + t * ray.direction - glm::dvec3(view.to_world[3]),
                                 glm::dvec3(view.to_world[2]));
            };
            const auto hit = tracer.closest_hit(ray);
            if (hit) {
                EXPECT_GT(depth(hit->t), view.near - 1e-6);
                EXPECT_LT(depth(hit->t), view.far + 1e-6);
            }
            ray.start = 0;
            ray.end = std::numeric_limits<double>::infinity();
            const auto whole = tracer.closest_hit(ray);
            if (whole && depth(whole->t) > view.near && depth(whole->t) < view.far) {
                EXPECT_TRUE(hit && hit->t == whole->t);
            }
            hits += hit.has_value();
            clipped += whole && (!hit || hit->t != whole->t);
            if (std::abs(found[item].position.w - (hit ? hit->t : -1)) > 1e-4) ++differences;
        });
        EXPECT_LE(differences, 3);  // pixels whose ray grazes an edge
        EXPECT_GT(hits, 300);
        EXPECT_GT(clipped, 300);
    }
}

// Position, distance and normals of a plane seen at an angle, worked out by hand.
TEST(gbuffer, plane_by_hand) {
    const test::TestScene plane = test::make_scene([](GltfWriter& out) {
        Mesh mesh;
        mesh.add_quad({-50, -2, 50}, {100, 0, 0}, {0, 0, -100});
        out.add_mesh("plane", mesh, out.add_diffuse(glm::vec3(0.5f)));
    });
    const Camera camera = camera_at({0, 0, 0});  // looks along -z, half height tan = 0.5
    const Tiles tiles = all_tiles(64, 64, 32);
    FOR_EACH_DEVICE(device) {
        const std::vector<Surface> found = trace(device, plane.scene, camera, 8, tiles);
        const Surface& s = found[reference::item_of(tiles, 40, 60)];
        const double sx = 2 * 40.5 / 64 - 1;
        const double sy = 1 - 2 * 60.5 / 64;
        const glm::dvec3 direction(0.5 * sx, 0.5 * sy, -1);
        const double t = -2 / direction.y;
        EXPECT_NEAR(s.position.x, t * direction.x, 1e-5);
        EXPECT_NEAR(s.position.y, -2, 1e-6);
        EXPECT_NEAR(s.position.z, t * direction.z, 1e-5);
        EXPECT_NEAR(s.position.w, t * glm::length(direction), 1e-5);
        EXPECT_NEAR(s.normal.y, 1, 1e-6);
        EXPECT_EQ(s.front, 1u);
        EXPECT_LT(found[reference::item_of(tiles, 40, 5)].position.w, 0);  // above the horizon
    }
}

}  // namespace manylight
