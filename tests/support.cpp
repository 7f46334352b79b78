// SPDX-License-Identifier: MIT
#include "support.hpp"

#include <unistd.h>

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <filesystem>

#include "scene/gltf/load.hpp"
#include "verify/stages.hpp"

namespace manylight::test {
namespace {

namespace fs = std::filesystem;

// Closed on all sides; lit from within.
void add_room(GltfWriter& out, glm::vec3 size) {
    Mesh floor;
    floor.add_quad({-size.x, 0, size.z}, {2 * size.x, 0, 0}, {0, 0, -2 * size.z});
    floor.add_quad({-size.x, size.y, -size.z}, {2 * size.x, 0, 0}, {0, 0, 2 * size.z});
    Mesh walls;
    walls.add_quad({-size.x, 0, -size.z}, {2 * size.x, 0, 0}, {0, size.y, 0});
    walls.add_quad({-size.x, 0, size.z}, {0, 0, -2 * size.z}, {0, size.y, 0});
    walls.add_quad({size.x, 0, -size.z}, {0, 0, 2 * size.z}, {0, size.y, 0});
    out.add_mesh("floor", floor, out.add_diffuse({0.7f, 0.65f, 0.6f}));
    out.add_mesh("walls", walls, out.add_diffuse({0.4f, 0.5f, 0.7f}));
}

void make_points(GltfWriter& out) {
    add_room(out, {2, 2, 2});
    Mesh boxes;
    boxes.add_box({-0.7f, 0, 0}, {0.8f, 1.1f, 0.5f}, 0.4f);
    boxes.add_box({0.6f, 0, 0.6f}, {0.6f, 0.6f, 0.6f}, -0.3f);
    boxes.add_box({0, 0, -1.2f}, {1.5f, 1.7f, 0.05f});
    out.add_mesh("boxes", boxes, out.add_diffuse({0.8f, 0.8f, 0.3f}));
    for (int i = 0; i < 24; ++i) {
        const float angle = 0.9f * static_cast<float>(i);
        out.add_point({1.6f * std::cos(angle), 1.2f + 0.6f * std::sin(3 * angle),
                       i % 4 == 0 ? -1.7f : 1.2f * std::sin(angle)},
                      glm::vec3(0.2f + 0.1f * static_cast<float>(i % 5), 0.4f, 0.5f));
    }
    out.add_camera("front", {0.2f, 1.1f, 1.95f}, {0, 0.9f, 0}, 1.2f, 1.6f);
}

Mesh make_ball(glm::vec3 centre, float radius) {
    Mesh mesh;
    constexpr int rings = 12;
    constexpr int spokes = 20;
    for (int i = 0; i <= rings; ++i)
        for (int j = 0; j < spokes; ++j) {
            const float a = 3.14159265f * static_cast<float>(i) / rings;
            const float b = 6.28318531f * static_cast<float>(j) / spokes;
            const glm::vec3 n(std::sin(a) * std::cos(b), std::cos(a), std::sin(a) * std::sin(b));
            mesh.positions.push_back(centre + radius * n);
            mesh.normals.push_back(n);
        }
    const auto at = [](int i, int j) {
        return static_cast<std::uint32_t>(i * spokes + j % spokes);
    };
    for (int i = 0; i < rings; ++i)
        for (int j = 0; j < spokes; ++j)
            for (const std::uint32_t k : {at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j),
                                          at(i, j + 1), at(i + 1, j + 1)})
                mesh.indices.push_back(k);
    return mesh;
}

void make_kinds(GltfWriter& out) {
    Mesh floor;
    floor.add_quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6});
    out.add_mesh("floor", floor, out.add_material({0.5f, 0.5f, 0.55f}, 0.6f, 0.5f));
    out.add_mesh("ball", make_ball({-0.6f, 0.6f, 0}, 0.6f),
                 out.add_material({0.9f, 0.6f, 0.3f}, 1, 0.3f));
    Mesh hollow = make_ball({-1.9f, 0.4f, 0.9f}, 0.4f);  // its normals are opposite to its winding
    for (glm::vec3& n : hollow.normals) n = -n;
    out.add_mesh("hollow", hollow, out.add_diffuse({0.6f, 0.4f, 0.7f}));
    Mesh box;
    box.add_box({0.8f, 0, -0.4f}, {0.7f, 1, 0.7f}, 0.5f);
    out.add_mesh("box", box, out.add_diffuse({0.3f, 0.7f, 0.4f}));
    Mesh lamp;
    lamp.add_quad({-0.4f, 2.2f, -0.4f}, {0.5f, 0, 0}, {0, 0, 0.5f});
    lamp.add_triangle({1.8f, 0.4f, -1}, {1.6f, 1.4f, 0.2f}, {1.9f, 0.5f, 0.4f});
    out.add_mesh("lamp", lamp, out.add_emitter({6, 5, 4}));
    for (int i = 0; i < 4; ++i) {
        const float x = -1.5f + static_cast<float>(i);
        out.add_point({x, 1.6f, 1}, {0.5f, 0.4f, 0.6f});
        out.add_spot({x, 2, -1}, {0.3f, -1, 0.4f}, {2, 1.5f, 1},
                     0.2f + 0.1f * static_cast<float>(i), 0.7f);
    }
    out.add_directional({0.4f, -1, -0.5f}, {0.6f, 0.6f, 0.5f});
    out.add_camera("front", {0.3f, 1.5f, 3.6f}, {0, 0.6f, 0}, 0.9f, 1.6f);
}

void make_oriented(GltfWriter& out) {
    Mesh floor;
    floor.add_quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4});
    floor.add_box({0, 0, 0}, {0.8f, 0.9f, 0.8f}, 0.6f);
    floor.add_box({-1, 0.5f, 0.7f}, {0.5f, 0.1f, 0.5f});
    out.add_mesh("floor", floor, out.add_diffuse({0.6f, 0.6f, 0.6f}));
    Mesh lamp;
    lamp.add_quad({-0.5f, 2, -0.5f}, {1, 0, 0}, {0, 0, 1});
    out.add_mesh("lamp", lamp, out.add_emitter({8, 7, 5}));
    out.add_camera("front", {0, 1.6f, 4}, {0, 0.6f, 0}, 0.9f, 1.6f);
}

void make_many(GltfWriter& out) {
    add_room(out, {2, 2, 2});
    for (int i = 0; i < 700; ++i) {
        const float a = 2.399963f * static_cast<float>(i);
        const float r = 0.3f + 0.02f * static_cast<float>(i % 90) + (i % 5 == 0 ? 0.f : 3.f);
        out.add_point({r * std::cos(a), 0.2f + 0.0025f * static_cast<float>(i), r * std::sin(a)},
                      glm::vec3(0.02f, 0.03f, 0.025f));
    }
    out.add_camera("front", {0, 1, 1.9f}, {0, 0.9f, 0}, 1.2f, 1.6f);
}

// Removed with all its files at the end of the process.
struct Folder {
    fs::path path = fs::temp_directory_path() / fmt::format("manylight-tests-{}", getpid());
    Folder() { fs::create_directories(path); }
    ~Folder() {
        std::error_code error;
        fs::remove_all(path, error);
    }
};

}  // namespace

const std::vector<Device>& devices() {
    static const std::vector<Device> opened = [] {
        std::vector<Device> all;
        const std::vector<DeviceInfo> infos = list_devices();
        std::string last;
        for (std::size_t i = 0; i < infos.size(); ++i)
            if (infos[i].usable) all.push_back(Device::open(last = std::to_string(i)));
        if (all.empty()) throw std::runtime_error("no OpenCL device to test on");
        // What GPUs run, which need not be here, on the last one.
        all.insert(all.begin() + 1, Device::open(last, 0, 1));
        for (Device& device : all) device.refuse_warnings();
        return all;
    }();
    return opened;
}

std::string label(const Device& device) {
    return fmt::format("{}: {}, form {}", device.info().platform, device.info().name,
                       device.form().lanes);
}

std::string temporary(const std::string& name) {
    static const Folder folder;
    return (folder.path / name).string();
}

TestScene make_scene(const std::function<void(GltfWriter&)>& fill, unsigned width, unsigned height,
                     unsigned emitter_points) {
    GltfWriter writer;
    fill(writer);
    const std::string path = temporary("scene.glb");
    writer.write(path);
    TestScene out{load_scene(path), {}, width, height};
    add_emitters(out.scene, emitter_points);
    out.camera = make_camera(find_view(out.scene, ""), width, height);
    return out;
}

const std::vector<std::string>& scene_names() {
    static const std::vector<std::string> names = {"points", "kinds", "oriented", "many"};
    return names;
}

const TestScene& scene_named(const std::string& name) {
    static std::map<std::string, TestScene> made;
    if (made.empty()) {
        made.emplace("points", make_scene(make_points));
        made.emplace("kinds", make_scene(make_kinds));
        made.emplace("oriented", make_scene(make_oriented, 50, 37, 16));  // no whole tiles
        made.emplace("many", make_scene(make_many));
    }
    return made.at(name);
}

Verifier& verifier(const std::string& scene, const Device& device) {
    static std::map<std::string, std::unique_ptr<Verifier>> made;
    std::unique_ptr<Verifier>& entry = made[scene + " on " + label(device)];
    if (!entry) {
        const TestScene& s = scene_named(scene);
        VerifyOptions options;
        options.width = s.width;
        options.height = s.height;
        entry = std::make_unique<Verifier>(device, s.scene, s.camera, options);
    }
    return *entry;
}

void expect_pass(const Check& check) {
    EXPECT_GT(check.items, 0u) << check.stage;
    EXPECT_TRUE(check.passed()) << check.stage << ": " << check.failed << " of " << check.items
                                << " items fail and " << check.borderline
                                << " are borderline; the first: " << check.first_failure;
}

void expect_stage(const std::string& stage, Verifier& verifier) {
    const std::vector<Check> checks = check_stage(verifier, stage);
    EXPECT_FALSE(checks.empty()) << stage;
    for (const Check& check : checks) expect_pass(check);
}

FrameResult render(const Device& device, const TestScene& scene, RenderOptions options) {
    options.width = scene.width;
    options.height = scene.height;
    const unsigned lanes = device.form().bvh_width;
    const WideBvh bvh =
        build_wide_bvh(scene.scene, lanes, lanes, reach_of(scene.scene, scene.camera));
    Frame frame(device, scene.scene, bvh, scene.camera, options);
    frame.prepare();
    Progress quiet("", true);
    FrameResult result = frame.render(quiet);
    frame.memory().check();
    return result;
}

double chi_squared_tail(double x, double k) {
    return cdf(complement(boost::math::chi_squared(k), x));
}

double student_tail(double t, double k) {
    return 2 * cdf(complement(boost::math::students_t(k), std::abs(t)));
}

}  // namespace manylight::test
