// SPDX-License-Identifier: MIT
// What single precision leaves of a scene: shadows on grounds of any size, scenes far from their
// file's origin, lights seen from afar.
#include <cmath>
#include <fstream>
#include <optional>

#include "commands/describe.hpp"
#include "output/metrics.hpp"
#include "reference/gbuffer.hpp"
#include "scene/gltf/file.hpp"
#include "scene/gltf/load.hpp"
#include "support.hpp"

namespace manylight {
namespace {

RenderOptions all_lights() {
    RenderOptions options;
    options.sampler = "exhaustive";
    options.spp = 1;
    return options;
}

double brightness(const Image& image, unsigned x, unsigned y) {
    const float* p = image.at(x, y);
    return luminance(glm::vec3(p[0], p[1], p[2]));
}

bool differ(double found, double expected) {
    return !(std::abs(found - expected) <= 0.01 * std::max(found, expected));
}

// A level or tilted ground through the origin, a square of that half side about `middle`.
struct Ground {
    float half;
    glm::vec2 middle{0};
    glm::vec2 tilt{0};  // how much it rises along x and z
    [[nodiscard]] glm::vec3 at(float x, float z) const { return {x, tilt.x * x + tilt.y * z, z}; }
    [[nodiscard]] Mesh mesh() const {
        Mesh mesh;
        const glm::vec2 low = middle - half;
        const glm::vec2 high = middle + half;
        const glm::vec3 corner = at(low.x, high.y);
        mesh.add_quad(corner, at(high.x, high.y) - corner, at(low.x, low.y) - corner);
        return mesh;
    }
    [[nodiscard]] std::string name() const {
        return fmt::format("ground of {} m about {} {}, rising by {} {}", 2 * half, middle.x,
                           middle.y, tilt.x, tilt.y);
    }
};

// Of 1 m to 1000 km, with and without the quad's diagonal in view, level and tilted. All numbers
// are ones that single precision holds, so that the corners lie in one plane.
std::vector<Ground> grounds() {
    std::vector<Ground> all;
    for (const float half : {0.5f, 16.f, 1024.f, 16384.f, 524288.f}) {
        all.push_back({half});
        all.push_back({half, glm::vec2(0.25f * half, -0.125f * half)});
        all.push_back({half, glm::vec2(0), glm::vec2(0x1p-10f, -0x1p-12f)});
    }
    return all;
}

struct Box {
    glm::dvec3 lower, upper;
    // Whether the segment from a to b goes through it.
    [[nodiscard]] bool is_between(const glm::dvec3& a, const glm::dvec3& b) const {
        double enter = 0;
        double leave = 1;
        for (int axis = 0; axis < 3; ++axis) {
            const double d = b[axis] - a[axis];
            const double one = (lower[axis] - a[axis]) / d;
            const double other = (upper[axis] - a[axis]) / d;
            enter = std::max(enter, std::min(one, other));
            leave = std::min(leave, std::max(one, other));
        }
        return enter < leave;
    }
};

// A .glb file as .gltf, with everything in it moved by a node above.
void write_moved(const std::string& from, const glm::dvec3& by, const std::string& name) {
    GltfFile file = read_gltf(from);
    nlohmann::json& nodes = file.json["nodes"];
    nlohmann::json& roots = file.json["scenes"][0]["nodes"];
    nodes.push_back({{"translation", {by.x, by.y, by.z}}, {"children", roots}});
    roots = {nodes.size() - 1};
    file.json["buffers"][0]["uri"] = name + ".bin";
    std::ofstream(test::temporary(name + ".bin"), std::ios::binary)
        .write(reinterpret_cast<const char*>(file.binary->data()),
               static_cast<std::streamsize>(file.binary->size()));
    std::ofstream(test::temporary(name)) << file.json;
}

// A scene, and the same moved.
test::TestScene moved(const std::function<void(GltfWriter&)>& fill, const glm::dvec3& by,
                      MeshStorage storage = MeshStorage::automatic) {
    GltfWriter writer;
    fill(writer);
    writer.write(test::temporary("unmoved.glb"));
    write_moved(test::temporary("unmoved.glb"), by, "moved.gltf");
    test::TestScene out{
        load_scene(test::temporary("moved.gltf"), {.storage = storage}), {}, 48, 36};
    add_emitters(out.scene, 0);
    out.camera = make_camera(find_view(out.scene, ""), out.width, out.height);
    return out;
}

// By round numbers, which leave every position as it was, by others, and by too little to matter.
const std::vector<glm::dvec3> moves = {{2000, 0, 0},
                                       {0, 1e6, -3e5},
                                       {1e7, 0, 0},
                                       {123.4, -567.8, 91.2},
                                       {1234567.8, 98.7, -7654321},
                                       {31.4, -15.9, 26.5}};

// A room with instances, lamps of all kinds and a card 3 mm below one.
void make_room(GltfWriter& out) {
    Mesh room;
    room.add_quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4});
    room.add_walls(2, 2.5f);
    const int grey = out.add_diffuse(glm::vec3(0.7f));
    out.add_mesh("room", room, grey);
    Mesh box;
    box.add_box({0, 0, 0}, {0.5f, 0.7f, 0.4f}, 0.4f);
    const int shape = out.add_shape("box", box, out.add_diffuse({0.7f, 0.3f, 0.2f}));
    for (const float x : {-0.9f, 0.1f, 1.1f}) {
        glm::mat4 place(1);
        place[3] = glm::vec4(x, 0, -0.3f + 0.2f * x, 1);
        out.add_node("", shape, place);
    }
    Mesh lamp;
    lamp.add_quad({-0.05f, 1.6f, -0.05f}, {0.1f, 0, 0}, {0, 0, 0.1f});
    out.add_mesh("lamp", lamp, out.add_emitter({300, 270, 210}));
    Mesh card;
    card.add_quad({-0.06f, 1.597f, 0.06f}, {0.12f, 0, 0}, {0, 0, -0.12f});
    out.add_mesh("card", card, grey);
    out.add_point({-1.2f, 1.9f, 0.7f}, glm::vec3(3));
    out.add_spot({1.3f, 2, 0.5f}, {-0.3f, -1, -0.2f}, glm::vec3(8), 0.3f, 0.6f);
    out.add_directional({0.3f, -1, -0.4f}, glm::vec3(0.5f));
    out.add_camera("front", {0.1f, 1.4f, 1.9f}, {0, 0.5f, 0}, 1.1f, 4.f / 3);
}

}  // namespace

// Light and shadow of a box 2 cm high, worked out by hand.
TEST(precision, shadow_of_a_small_box_on_any_ground) {
    constexpr unsigned width = 96;
    constexpr unsigned height = 72;
    const glm::dvec3 lamp(0.375, 0.125, 0.1875);
    const Box box{{-0.0625, -0.01171875, -0.0625}, {0.0625, 0.01953125, 0.0625}};
    const Tiles tiles = all_tiles(width, height, 32);
    for (const Ground& ground : grounds()) {
        SCOPED_TRACE(ground.name());
        const test::TestScene s = test::make_scene(
            [&](GltfWriter& out) {
                const int grey = out.add_diffuse(glm::vec3(0.5f));
                out.add_mesh("ground", ground.mesh(), grey);
                Mesh mesh;
                mesh.add_box({0, box.lower.y, 0}, box.upper - box.lower);
                out.add_mesh("box", mesh, grey);
                out.add_point(lamp, glm::vec3(1));
                out.add_camera("front", {0, 0.35f, 0.45f}, {0, 0, 0}, 0.45f, 4.f / 3);
            },
            width, height);
        const glm::dvec3 up = glm::normalize(glm::dvec3(-ground.tilt.x, 1, -ground.tilt.y));
        FOR_EACH_DEVICE(device) {
            const Image image = test::render(device, s, all_lights()).image;
            int dark = 0;
            int lit = 0;
            int wrong = 0;
            for (unsigned y = 0; y < height; ++y)
                for (unsigned x = 0; x < width; ++x) {
                    const reference::Ray ray =
                        reference::primary_ray(s.camera, tiles, glm::dvec2(x, y) + 0.5);
                    const double t = -glm::dot(up, ray.origin) / glm::dot(up, ray.direction);
                    const glm::dvec3 p = ray.origin + t * ray.direction;
                    const double reach =
                        std::max(std::abs(p.x - ground.middle.x), std::abs(p.z - ground.middle.y));
                    if (t < 0 || reach > ground.half || box.is_between(ray.origin, p)) continue;
                    const glm::dvec3 d = lamp - p;
                    const double distance = glm::length(d);
                    double expected =
                        0.5 / 3.14159265358979 * glm::dot(up, d) / (distance * distance * distance);
                    if (box.is_between(p, lamp)) expected = 0;
                    ++(expected > 0 ? lit : dark);
                    if (differ(brightness(image, x, y), expected)) ++wrong;
                }
            EXPECT_GT(dark, 400);
            EXPECT_GT(lit, 1000);
            EXPECT_LE(wrong, 0.01 * dark);
        }
    }
}

// What a lamp with a card 3 mm below it lights, on any ground as on a small one.
TEST(precision, card_under_a_lamp_on_any_ground) {
    std::optional<Image> small;
    for (const Ground& ground : grounds()) {
        if (ground.half < 2 || ground.tilt != glm::vec2(0)) continue;
        SCOPED_TRACE(ground.name());
        const test::TestScene s = test::make_scene([&](GltfWriter& out) {
            const int grey = out.add_diffuse(glm::vec3(0.5f));
            out.add_mesh("ground", ground.mesh(), grey);
            Mesh card;
            card.add_quad({-0.06f, 0.997f, 0.06f}, {0.12f, 0, 0}, {0, 0, -0.12f});
            out.add_mesh("card", card, grey);
            Mesh lamp;
            lamp.add_quad({-0.05f, 1, -0.05f}, {0.1f, 0, 0}, {0, 0, 0.1f});
            out.add_mesh("lamp", lamp, out.add_emitter({2000, 1800, 1400}));
            out.add_camera("front", {0, 1.5f, 3}, {0, 0.3f, 0}, 0.8f, 1.6f);
        });
        const Image image = test::render(test::devices().front(), s, all_lights()).image;
        if (!small) small = image;
        int lit = 0;
        int dark = 0;
        int wrong = 0;
        for (unsigned y = s.height / 2; y < s.height; ++y)
            for (unsigned x = 0; x < s.width; ++x) {
                ++(brightness(image, x, y) > 0 ? lit : dark);
                if (differ(brightness(image, x, y), brightness(*small, x, y))) ++wrong;
            }
        EXPECT_GT(dark, 600);
        EXPECT_LE(wrong, 0.01 * dark);
    }
}

TEST(precision, moved_scenes_look_as_before) {
    for (const MeshStorage storage : {MeshStorage::copied, MeshStorage::shared}) {
        const test::TestScene unmoved = moved(make_room, glm::dvec3(0), storage);
        EXPECT_EQ(unmoved.scene.origin, glm::dvec3(0));
        EXPECT_EQ(unmoved.scene.instances.empty(), storage == MeshStorage::copied);
        RenderOptions options = all_lights();
        options.aovs = {"position"};
        const Device& device = test::devices().front();
        const FrameResult before = test::render(device, unmoved, options);
        for (const glm::dvec3& by : moves) {
            SCOPED_TRACE(fmt::format("moved by {} {} {}", by.x, by.y, by.z));
            const test::TestScene there = moved(make_room, by, storage);
            EXPECT_EQ(there.scene.origin != glm::dvec3(0), glm::length(by) > 100);
            const FrameResult after = test::render(device, there, options);
            EXPECT_LE(compare_images(after.image, before.image, "moved", "unmoved").relmse, 1e-6);
            if (by == glm::trunc(by)) {
                EXPECT_EQ(after.image.values, before.image.values);
            }
            // What is said of positions is in the file's frame.
            const double rounding = 1e-7 * glm::length(by) + 1e-4;
            const Image& places = after.aovs[0].second;
            const Image& old_places = before.aovs[0].second;
            for (unsigned y = 0; y < places.height; y += 5)
                for (unsigned x = 0; x < places.width; x += 5)
                    for (int axis = 0; axis < 3; ++axis)
                        EXPECT_NEAR(places.at(x, y)[axis], old_places.at(x, y)[axis] + by[axis],
                                    rounding);
            for (std::size_t light = 0; light < there.scene.lights.size(); ++light) {
                const auto old_place = describe(unmoved.scene, light);
                const auto place = describe(there.scene, light);
                for (int axis = 0; axis < 3 && place.contains("position"); ++axis)
                    EXPECT_NEAR(place["position"][axis].get<double>(),
                                old_place["position"][axis].get<double>() + by[axis], 1e-5);
            }
        }
    }
}

TEST(precision, origin_of_a_scene) {
    const auto origin = [](const glm::vec3& lower, const glm::vec3& upper) {
        Bounds bounds;
        bounds.add(lower);
        bounds.add(upper);
        return find_origin(bounds);
    };
    EXPECT_EQ(find_origin(Bounds()), glm::dvec3(0));
    EXPECT_EQ(origin({-1, 0, -1}, {5, 3, 1}), glm::dvec3(0));
    EXPECT_EQ(origin({95.9f, 0, 0}, {101.9f, 3, 4}), glm::dvec3(0));
    EXPECT_EQ(origin({96.1f, 0, 0}, {102.1f, 3, 4}), glm::dvec3(96, 0, 0));
    EXPECT_EQ(origin({-2e6f, -2, 1e5f}, {-2e6f + 4, 1, 1e5f + 1}), glm::dvec3(-2e6, 0, 1e5));
    EXPECT_EQ(origin(glm::vec3(7), glm::vec3(7)), glm::dvec3(7));  // a point
}

// A lamp far from a small wall, both of them turned: no part of it is hidden by itself.
TEST(precision, lamps_seen_from_afar) {
    const glm::vec3 facing(-0.8f, 0, 0.6f);
    const glm::vec3 aside(0.6f, 0, 0.8f);
    for (const auto& [distance, side] :
         {std::pair(10.f, 1.f), {1000.f, 1.f}, {1000.f, 30.f}, {1e5f, 1.f}, {1e5f, 30.f}}) {
        SCOPED_TRACE(fmt::format("a lamp of {} m, {} m away", side, distance));
        const glm::vec3 wall = distance * facing;
        const test::TestScene s = test::make_scene(
            [&](GltfWriter& out) {
                Mesh lamp;
                lamp.add_quad(-side / 2 * (aside + glm::vec3(0, 1, 0)), side * aside, {0, side, 0});
                out.add_mesh("lamp", lamp, out.add_emitter(glm::vec3(1e6f)));
                Mesh mesh;
                mesh.add_quad(wall + 0.1f * distance * (aside - glm::vec3(0, 1, 0)),
                              -0.2f * distance * aside, {0, 0.2f * distance, 0});
                out.add_mesh("wall", mesh, out.add_diffuse(glm::vec3(0.5f)));
                out.add_camera("front", wall - 0.1f * distance * facing, wall, 0.9f, 1.6f);
            },
            32, 20);
        const double area = double{side} * side;
        const double expected = 0.5 / 3.14159265 * 1e6 * area / (double{distance} * distance);
        FOR_EACH_DEVICE(device) {
            const Image image = test::render(device, s, all_lights()).image;
            for (unsigned y = 0; y < s.height; ++y)
                for (unsigned x = 0; x < s.width; ++x)
                    EXPECT_NEAR(brightness(image, x, y), expected, 0.05 * expected)
                        << x << " " << y;
        }
    }
}

}  // namespace manylight
