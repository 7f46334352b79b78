// SPDX-License-Identifier: MIT
// What `verify` says, and when: its scenes, its record of kernels, its tolerances where single
// precision decides little.
#include "device/kernel_sources.hpp"
#include "support.hpp"
#include "verify/scene_maker.hpp"
#include "verify/scenes.hpp"
#include "verify/verify_all.hpp"

namespace manylight {
namespace {

const KernelCode& kernel_named(const std::vector<KernelCode>& kernels, std::string_view file,
                               std::string_view name) {
    static const KernelCode none;
    for (const KernelCode& k : kernels)
        if (k.file == file && k.name == name) return k;
    ADD_FAILURE() << name << " of " << file << " is not listed";
    return none;
}

TEST(verify, lists_every_kernel) {
    const std::vector<KernelCode> kernels = all_kernels();
    for (const auto& [file, text] : kernel_sources)
        if (file.ends_with(".cl")) {
            EXPECT_TRUE(std::ranges::any_of(kernels, [&](const KernelCode& k) {
                return k.file == file;
            })) << file;
        }
    for (const char* name : {"exhaustive", "uniform", "power", "ris", "lighttree", "contribution"})
        (void)kernel_named(kernels, fmt::format("samplers/{0}/{0}.cl", name), "samples_draw");
    const KernelCode& add = kernel_named(kernels, "accumulate.cl", "accumulate_add_pass");
    EXPECT_EQ(add.features,
              (std::set<std::string>{"HAS_EMISSION", "HAS_EMITTER_PARTS", "HAS_GROUPS"}));
    EXPECT_TRUE(kernel_named(kernels, "gbuffer.cl", "gbuffer_trace_rays")
                    .features.contains("HAS_SPECULAR_MAPS"));
    EXPECT_TRUE(
        kernel_named(kernels, "samplers/ris/ris.cl", "samples_draw").features.contains("HAS_SPOT"));
}

// What kernels do by a scene's data, not by how they are compiled, no record of launches shows.
TEST(verify, scenes_hold_everything) {
    std::set<std::string> has;
    const auto note = [&](bool is, const std::string& what) {
        if (is) has.insert(what);
    };
    for (const VerifyScene& made : verify_scenes()) {
        const Scene& s = made.scene;
        for (const Light& light : s.lights) {
            const auto kind = static_cast<int>(light.position.w);
            has.insert(fmt::format("light {}", kind));
            if (kind == LIGHT_POINT || kind == LIGHT_SPOT)
                has.insert(fmt::format("light {}, {} range", kind, light.axis.w > 0 ? "a" : "no"));
            if (kind == LIGHT_TRIANGLE || kind == LIGHT_QUAD)
                has.insert(fmt::format("light {}, {} sides", kind, light.axis.w > 0 ? 2 : 1));
        }
        for (const Texture& t : s.textures) {
            has.insert(fmt::format("format {}", t.format));
            has.insert(fmt::format("wrap u {}", t.wrap_u));
            has.insert(fmt::format("wrap v {}", t.wrap_v));
            has.insert(fmt::format("levels {}", t.between));
            has.insert(fmt::format("linear {}", t.magnified_linear));
        }
        for (std::size_t i = 0; i < s.maps.size(); ++i)
            note(s.maps[i].texture != NO_TEXTURE, fmt::format("map {}", i % MAP_KIND_COUNT));
        for (const Material& m : s.materials) {
            note(m.cutoff > 0, "mask");
            note(m.cutoff < 0, "blend");
            note(m.culled != 0, "culled");
            note(m.unlit != 0, "unlit");
            note(m.specular > 0 && m.base_color.w < 1, "dielectric");
            note(m.base_color.w > 0, "metal");
            note(m.roughness < REFLECTING_ALPHA, "polished");
            note(m.specular == 0, "Lambert");
            note(m.emission.x > 0 && m.unlit == 0, "emitter");
        }
        for (const float4& t : s.tangents) has.insert(fmt::format("tangent {}", t.w));
        for (const Instance& in : s.instances) has.insert(fmt::format("mirrored {}", in.mirrored));
        note(!s.colors.empty(), "colors");
        note(!s.vertex_normals.empty(), "normals");
        note(s.lights.size() > CUT_CAPACITY, "many lights");
    }
    std::set<std::string> all = {"mask",       "blend",     "culled",     "unlit",
                                 "dielectric", "metal",     "polished",   "Lambert",
                                 "emitter",    "colors",    "normals",    "many lights",
                                 "tangent 0",  "tangent 1", "tangent -1", "mirrored 0",
                                 "mirrored 1", "linear 0",  "linear 1"};
    for (int kind = 0; kind < light_kind_count; ++kind) all.insert(fmt::format("light {}", kind));
    for (const int kind : {LIGHT_POINT, LIGHT_SPOT})
        for (const char* range : {"a", "no"})
            all.insert(fmt::format("light {}, {} range", kind, range));
    for (const int sides : {1, 2})
        all.insert(fmt::format("light {}, {} sides", int{LIGHT_QUAD}, sides));
    all.insert(fmt::format("light {}, 2 sides", int{LIGHT_TRIANGLE}));
    for (int i = 0; i < 3; ++i)
        for (const char* what : {"format", "wrap u", "wrap v", "levels"})
            all.insert(fmt::format("{} {}", what, i));
    for (int kind = 0; kind < MAP_KIND_COUNT; ++kind) all.insert(fmt::format("map {}", kind));
    for (const std::string& what : all) EXPECT_TRUE(has.contains(what)) << what;
}

// Whatever is left out, or was not told anything about, is named.
TEST(verify, names_what_is_left_out) {
    FOR_EACH_DEVICE(device) {
        Verification less{{}, Coverage(device.form().lanes > 1), true};
        Check silent{.stage = "reflections", .tolerance = ""};
        silent.compare(0, 0, "", true);
        less.coverage.add({{"reflections.cl", "reflections_trace", "reflections", {}}}, {silent});
        less.scenes.push_back({"one", "", 0, 0, 0, 0, {silent}});
        const std::string verdict = less.verdict();
        EXPECT_EQ(verdict.find("computes correctly"), std::string::npos) << verdict;
        for (const char* word : {"stage reflections", "reflections_trace of reflections.cl",
                                 "samples_draw of samplers/ris/ris.cl", "accumulate_add_pass"})
            EXPECT_NE(verdict.find(word), std::string::npos) << word << " in\n" << verdict;
    }
}

// A kernel is tested only with the features that it was compiled with where a check told something.
TEST(verify, names_features_that_are_left_out) {
    Coverage coverage(true);
    Check told{.stage = "gbuffer", .tolerance = ""};
    told.compare(0, 1, "");
    Defines defines = {{"HAS_SMOOTH", 1}, {"HAS_COLORS", 0}};
    coverage.add({{"gbuffer.cl", "gbuffer_trace_packets", "gbuffer", defines}}, {told});
    const std::vector<KernelCode> kernels = all_kernels();
    const KernelCode& packets = kernel_named(kernels, "gbuffer.cl", "gbuffer_trace_packets");
    const auto lacks = [&](const char* feature, bool with) {
        const std::vector<std::string> missing = coverage.missing(packets, with);
        return std::ranges::find(missing, feature) != missing.end();
    };
    EXPECT_EQ(coverage.state(packets), Coverage::State::tested);
    EXPECT_FALSE(lacks("HAS_SMOOTH", true));
    EXPECT_TRUE(lacks("HAS_SMOOTH", false));
    EXPECT_TRUE(lacks("HAS_COLORS", true));
    EXPECT_TRUE(lacks("HAS_TANGENTS", true));
    EXPECT_EQ(coverage.state(kernel_named(kernels, "gbuffer.cl", "gbuffer_trace_rays")),
              Coverage::State::not_tested);
    EXPECT_EQ(coverage.state(kernel_named(kernels, "shadows.cl", "shadows_trace_rays")),
              Coverage::State::other_form);
    EXPECT_EQ(coverage.state(kernel_named(kernels, "bench.cl", "bench_closest_rays")),
              Coverage::State::not_rendering);
}

// What follows is about the host's judgement, for which one device will do.

// Rays that pass by another chance than the material says.
TEST(verify, tells_a_wrong_share) {
    Check check{.stage = "share", .tolerance = ""};
    compare_share(check, 3000 + 229, 10000, 0.3, "");
    EXPECT_EQ(check.failed, 0u);
    compare_share(check, 3000 - 230, 10000, 0.3, "");
    EXPECT_EQ(check.failed, 1u);
}

// Many items that rounding decides pass only where about as many of those that agree are of the
// same kind.
TEST(verify, borderline_items_are_counted) {
    Check check{.stage = "any", .tolerance = ""};
    for (int i = 0; i < 1000; ++i) check.compare(0, 1, "");
    for (int i = 0; i < 100; ++i) check.skip_borderline();
    EXPECT_FALSE(check.passed());
    check.excuse_agreeing(1000, [](std::size_t i) { return i % 50 == 0 ? 1 : 0; });
    EXPECT_FALSE(check.passed());
    check.excuse_agreeing(1000, [](std::size_t i) { return i % 5 == 0 ? 1 : 0; });
    EXPECT_TRUE(check.passed());
    check.compare(2, 1, "");
    EXPECT_FALSE(check.passed());
}

void expect_all_pass(const Device& device, const Scene& scene, const View& view, unsigned width,
                     unsigned height) {
    VerifyOptions options;
    options.width = width;
    options.height = height;
    options.most_entries = 10'000;
    Verifier verifier(device, scene, make_camera(view, width, height), options);
    for (const Check& check : verifier.all())
        if (check.tested()) test::expect_pass(check);
}

// Emitters 10,000 to a million times as long as wide: single precision hardly knows which way they
// face, and where their own plane stops rays.
TEST(verify, slivers) {
    SceneMaker maker;
    Mesh floor;
    floor.add_quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6});
    maker.add(floor, maker.add(diffuse(glm::vec3(0.7f))));
    Mesh slivers;
    for (int i = 0; i < 60; ++i) {
        const auto k = static_cast<float>(i);
        const glm::vec3 at(2.5f * std::sin(7 * k), 0.5f + 0.04f * k, 2.5f * std::cos(5 * k));
        const glm::vec3 along(std::sin(3 * k), std::cos(2 * k), std::sin(k));
        const float width = std::pow(10.f, -4 - 0.4f * static_cast<float>(i % 6));
        const glm::vec3 across = width * glm::normalize(glm::cross(along, {0.3f, 0.2f, 0.9f}));
        slivers.add_triangle(at, at + along, at + 0.4f * along + across);
    }
    maker.add(slivers, maker.add(emitter(glm::vec3(50), true)));
    const Scene scene = maker.finish();
    const Device& device = test::devices().back();
    expect_all_pass(device, scene, look({0, 2.5, 5}, {0, 0.5, 0}, 0.8), 48, 36);
}

// A spot of a quarter of a degree whose edge is a hundred thousandth of its cosine wide.
TEST(verify, sharp_beam) {
    SceneMaker maker;
    Mesh wall;
    wall.add_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
    maker.add(wall, maker.add(diffuse(glm::vec3(1))));
    maker.add(spot_light({0, 0, 10}, {0, 0, -1}, glm::vec3(314), 0.0043633f, 0.0043633f));
    const Scene scene = maker.finish();
    View view;
    view.orthographic = true;
    view.half_height = 0.0873;
    view.to_world[3] = glm::dvec4(0, 0, 1, 1);
    const Device& device = test::devices().back();
    expect_all_pass(device, scene, view, 48, 36);
}

// An emitter of metal, all of which is in its own plane: what light it gives itself is rounding.
TEST(verify, emitter_in_its_own_plane) {
    SceneMaker maker;
    Mesh floor;
    floor.add_quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4});
    maker.add(floor, maker.add(glossy(glm::vec3(1), 0, 1)));
    Mesh lamp;
    lamp.add_quad({-1, 1, 0}, {2, 0, 0}, {0, std::sin(1.1f), -std::cos(1.1f)});
    Material metal = glossy(glm::vec3(1), 1, 1);
    metal.emission = float4(10, 10, 10, 1);
    maker.add(lamp, maker.add(metal));
    const Scene scene = maker.finish();
    const Device& device = test::devices().back();
    for (const unsigned width : {47u, 49u})
        expect_all_pass(device, scene, look({0, 1.5, 5}, {0, 1.5, 0}, 0.8), width, width * 3 / 4);
}

// A directional light that slants over strips by a hundredth of a degree to a few: the cosine is
// little more than rounding.
TEST(verify, grazing_sun) {
    SceneMaker maker;
    Mesh strips;
    const glm::vec3 along = glm::normalize(glm::vec3(0.7f, 0.2f, -0.5f));  // of the light
    const glm::vec3 across = glm::normalize(glm::cross(along, {0.3f, 0.9f, 0.1f}));
    const glm::vec3 up = glm::cross(across, along);
    for (int i = 0; i < 24; ++i) {
        const float tilt = std::pow(10.f, -4 + 0.1f * static_cast<float>(i));
        const glm::vec3 side = along + tilt * up;
        strips.add_quad(0.1f * static_cast<float>(i - 12) * across - side, 0.09f * across,
                        2.f * side);
    }
    maker.add(strips, maker.add(diffuse(glm::vec3(0.7f))));
    maker.add(directional_light(along, glm::vec3(3)));
    const Scene scene = maker.finish();
    const Device& device = test::devices().back();
    const glm::dvec3 from(3.f * up + 0.3f * along);
    expect_all_pass(device, scene, look(from, {0, 0, 0}, 0.8), 48, 36);
}

// A ground of 200 km of two triangles, whose common edge, as rounded, is centimetres wide.
TEST(verify, wide_ground) {
    SceneMaker maker;
    Mesh ground;
    ground.add_quad({-1e5f, 0, 1e5f}, {2e5f, 0, 0}, {0, 0, -2e5f});
    maker.add(ground, maker.add(diffuse(glm::vec3(0.5f))));
    Mesh box;
    box.add_box({0, 0, 0}, {0.02f, 0.02f, 0.02f});
    maker.add(box, maker.add(diffuse({0.7f, 0.4f, 0.3f})));
    maker.add(point_light({0.25f, 0.3f, 0.1f}, glm::vec3(1)));
    const Scene scene = maker.finish();
    const Device& device = test::devices().back();
    expect_all_pass(device, scene, look({0, 0.35, 0.45}, {0, 0, 0}, 0.8), 48, 36);
}

}  // namespace
}  // namespace manylight
