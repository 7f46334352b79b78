// SPDX-License-Identifier: MIT
// Is each sampler's mean over many seeds the all-lights image? One test for all: Student's t at
// every pixel and for the image's mean, corrected for the number of pixels. All samplers run
// on every device, the rest on one: what devices do differently, the tests of stages see.
#include <cmath>

#include "reference/gbuffer.hpp"
#include "support.hpp"

namespace manylight {
namespace {

struct Statistics {
    double smallest_pixel = 1;  // smallest probability of any pixel's t, times the pixels
    double mean = 1;            // probability of the image mean's t
    double bias = 0;            // mean over the reference's, minus 1
};

// Luminance per pixel, then the image's mean.
std::vector<double> luminances(const Image& image) {
    std::vector<double> out;
    double sum = 0;
    for (std::size_t i = 0; i < image.pixel_count(); ++i) {
        const float* p = image.values.data() + 3 * i;
        out.push_back(luminance(glm::vec3(p[0], p[1], p[2])));
        sum += out.back();
    }
    out.push_back(sum / static_cast<double>(image.pixel_count()));
    return out;
}

struct Moments {
    std::vector<double> sum, squares;
    int count = 0;
    void add(const std::vector<double>& values) {
        sum.resize(values.size());
        squares.resize(values.size());
        for (std::size_t i = 0; i < values.size(); ++i) {
            sum[i] += values[i];
            squares[i] += values[i] * values[i];
        }
        ++count;
    }
    [[nodiscard]] double mean(std::size_t i) const { return sum[i] / count; }
    // Of the mean.
    [[nodiscard]] double variance(std::size_t i) const {
        return std::max(squares[i] / count - mean(i) * mean(i), 0.0) / (count - 1);
    }
};

Moments render_seeds(const Device& device, const test::TestScene& scene, RenderOptions options,
                     int seeds) {
    Moments moments;
    for (int i = 0; i < seeds; ++i) {
        options.seed = static_cast<uint>(1000 + i);
        moments.add(luminances(test::render(device, scene, options).image));
    }
    return moments;
}

// The variance of a pixel's mean: its own or the mean of its neighbourhood of 5 x 5, whichever is
// larger. Its own alone takes for certainty what a few seeds did not meet, such as a light that is
// drawn once in a thousand samples.
double variance_about(const Moments& moments, std::size_t pixel, const test::TestScene& scene) {
    const int x = static_cast<int>(pixel % scene.width);
    const int y = static_cast<int>(pixel / scene.width);
    double sum = 0;
    int count = 0;
    for (int v = std::max(y - 2, 0); v <= std::min<int>(y + 2, scene.height - 1); ++v)
        for (int u = std::max(x - 2, 0); u <= std::min<int>(x + 2, scene.width - 1); ++u) {
            sum += moments.variance(v * scene.width + u);
            ++count;
        }
    return std::max(moments.variance(pixel), sum / count);
}

Statistics judge(const Moments& found, const Moments& reference, const test::TestScene& scene) {
    Statistics out;
    const std::size_t pixels = found.sum.size() - 1;
    for (std::size_t i = 0; i <= pixels; ++i) {
        const double difference = found.mean(i) - reference.mean(i);
        // What summing in single precision may do, besides chance.
        const double rounding = 1e-6 * reference.mean(i) + 1e-9;
        if (std::abs(difference) <= rounding) continue;
        double variance = i == pixels ? found.variance(i) : variance_about(found, i, scene);
        if (reference.count > 1) variance += reference.variance(i);
        const double t = difference / std::max(std::sqrt(variance), rounding);
        const double p = test::student_tail(t, found.count - 1);
        if (i == pixels)
            out.mean = p;
        else
            out.smallest_pixel = std::min(out.smallest_pixel, p * static_cast<double>(pixels));
    }
    out.bias = found.mean(pixels) / reference.mean(pixels) - 1;
    return out;
}

RenderOptions options_for(std::string_view sampler, uint light_samples) {
    RenderOptions options;
    options.sampler = sampler;
    options.light_samples = light_samples;
    options.spp = 4;
    options.pixel_centre = true;
    return options;
}

constexpr double significance = 1e-3;

void expect_unbiased(const Statistics& s, double level = significance) {
    EXPECT_GT(s.smallest_pixel, level);
    EXPECT_GT(s.mean, level);
}

// A test scene at a size that many seeds are quick at.
test::TestScene small(const std::string& name) {
    test::TestScene scene = test::scene_named(name);
    scene.width = 32;
    scene.height = 20;
    scene.camera = make_camera(find_view(scene.scene, ""), scene.width, scene.height);
    return scene;
}

// A floor of metal on the left and of polished plastic, alpha 0.02, on the right, under lamps of
// one and of two cells; or with a box between them and the plastic's normals bent.
test::TestScene polished(float metal_roughness, bool occluded) {
    return test::make_scene(
        [&](GltfWriter& out) {
            Mesh left;
            left.add_quad({-2, 0, 2}, {2, 0, 0}, {0, 0, -4});
            out.add_mesh("left", left, out.add_material({0.8f, 0.7f, 0.6f}, 1, metal_roughness));
            Mesh right;
            right.add_quad({0, 0, 2}, {2, 0, 0}, {0, 0, -4});
            if (occluded)
                for (const float x : {0.f, 0.3f, 0.3f, 0.f})
                    right.normals.push_back(glm::normalize(glm::vec3(x, 1, 0)));
            out.add_mesh("right", right, out.add_material({0.4f, 0.3f, 0.5f}, 0, 0.14f));
            Mesh box;
            if (occluded) {
                box.add_box({-0.1f, 0.6f, -0.6f}, {0.4f, 0.3f, 0.2f}, 0.5f);
                out.add_mesh("box", box, out.add_diffuse(glm::vec3(0.5f)));
            }
            Mesh lamps;
            lamps.add_quad({-0.7f, 1.2f, -1}, {0.25f, 0, 0}, {0, 0, 0.2f});
            lamps.add_quad({0.2f, 1, -1.1f}, {0.45f, 0, 0}, {0, 0.15f, 0.2f});
            out.add_mesh("lamps", lamps, out.add_emitter({6, 5, 4}));
            out.add_camera("front", {0, 1, 1.4f}, {0, 0, -0.1f}, 0.7f, 1.6f);
        },
        16, 10);
}

// The image of the polished floor by quadrature: the whole BRDF over a fine grid on each lamp.
Image exact_image(const test::TestScene& scene) {
    constexpr int steps = 80;
    const reference::Tracer tracer(scene.scene);
    const Tiles tiles = all_tiles(scene.width, scene.height, 16);
    Image image(scene.width, scene.height, {"R", "G", "B"});
    for (uint y = 0; y < scene.height; ++y)
        for (uint x = 0; x < scene.width; ++x) {
            const Surface surface =
                reference::gbuffer(scene.scene, tracer, scene.camera, tiles, x, y, false, 0, 0);
            const glm::dvec3 position(surface.position);
            const glm::dvec3 normal(surface.normal);
            const glm::dvec3 wo = reference::Viewer(scene.camera).direction(position);
            glm::dvec3 sum(0);
            for (const Light& light : scene.scene.lights) {
                const glm::dvec3 u(light.axis);
                const glm::dvec3 v(light.edge);
                for (int i = 0; i < steps * steps; ++i) {
                    const glm::dvec3 d = glm::dvec3(light.position) - position +
                                         u * ((i % steps + 0.5) / steps) +
                                         v * ((i / steps + 0.5) / steps);
                    const double distance = glm::length(d);
                    const glm::dvec3 wi = d / distance;
                    const double emitted = -glm::dot(wi, glm::cross(u, v)) / (steps * steps);
                    if (emitted <= 0) continue;
                    sum +=
                        reference::brdf(scene.scene.materials[surface.material], normal, wi, wo) *
                        glm::dvec3(light.emission) *
                        (glm::dot(normal, wi) * emitted / (distance * distance));
                }
            }
            for (int c = 0; c < 3; ++c)
                image.values[3 * (std::size_t{y} * scene.width + x) + c] =
                    static_cast<float>(sum[c]);
        }
    return image;
}

}  // namespace

TEST(statistics, tails_of_the_distributions) {
    // Tables of Student's t and of chi-squared.
    EXPECT_NEAR(test::student_tail(2.228, 10), 0.05, 1e-4);
    EXPECT_NEAR(test::student_tail(4.587, 10), 0.001, 1e-5);
    EXPECT_NEAR(test::student_tail(-3.291, 1e6), 0.001, 1e-5);
    EXPECT_NEAR(test::chi_squared_tail(18.307, 10), 0.05, 1e-5);
    EXPECT_NEAR(test::chi_squared_tail(37.697, 15), 0.001, 1e-6);
}

// Numbers of light samples that tell a sampler's bias. To save time, devices but the first have
// one, and so have samplers to whose rays they hardly matter.
std::vector<uint> light_samples_of(const Sampler& sampler, bool first_device) {
    if (sampler.own_rays || !first_device) return {4};
    return {1, 4, 16};
}

// Every sampler that the table calls unbiased is, with 1, 4 and 16 light samples. Many of kinds'
// lights are cells that a cluster's representative does not face: t is Student's only where each of
// them was drawn often, which with few light samples takes more seeds.
TEST(statistics, unbiased_samplers_are_unbiased) {
    FOR_EACH_DEVICE(device)
    for (const std::string name : {"points", "kinds", "oriented"}) {
        const bool is_first = &device == &test::devices().front();
        const test::TestScene scene = small(name);
        const Moments reference =
            render_seeds(device, scene, options_for("exhaustive", 1), name == "kinds" ? 200 : 1);
        for (const Sampler& sampler : all_samplers()) {
            if (sampler.biased || sampler.all_lights) continue;
            for (const uint light_samples : light_samples_of(sampler, is_first)) {
                SCOPED_TRACE(
                    fmt::format("{} on {}, {} light samples", sampler.name, name, light_samples));
                const bool rare = sampler.clusters && light_samples < 16;
                const int seeds = name == "kinds" && rare ? 900 : light_samples == 16 ? 70 : 120;
                expect_unbiased(judge(
                    render_seeds(device, scene, options_for(sampler.name, light_samples), seeds),
                    reference, scene));
            }
        }
    }
}

// Samplers that go down light trees, on more lights than a cut has nodes, most of them hidden.
TEST(statistics, cuts_of_many_lights_are_unbiased) {
    const Device& device = test::devices().front();
    const test::TestScene scene = small("many");
    const Moments reference = render_seeds(device, scene, options_for("exhaustive", 1), 1);
    for (const std::string_view sampler : {"lighttree", "stochastic-lightcuts", "adaptive"})
        for (const uint light_samples : {1u, 4u, 20u, 40u}) {
            SCOPED_TRACE(fmt::format("{}, {} light samples", sampler, light_samples));
            expect_unbiased(
                judge(render_seeds(device, scene, options_for(sampler, light_samples), 120),
                      reference, scene));
        }
}

// However rendering stops: where the error is small enough (which is unbiased but for a small part
// of the noise, see docs/stopping.md), and in the middle of a sample where time is over.
TEST(statistics, stopped_renders_are_unbiased) {
    const Device& device = test::devices().front();
    const test::TestScene scene = small("points");
    const Moments reference = render_seeds(device, scene, options_for("exhaustive", 1), 1);
    RenderOptions options = options_for("adaptive", 0);
    options.spp = 64;
    options.target_error = 0.002;
    expect_unbiased(judge(render_seeds(device, scene, options, 100), reference, scene));
    options.target_error = 0;
    Moments by_time;
    for (options.seed = 0; options.seed < 100; ++options.seed) {
        options.deadline = Clock::now() + std::chrono::milliseconds(8 + options.seed % 8);
        by_time.add(luminances(test::render(device, scene, options).image));
    }
    // No two runs stop alike: one in a million may look biased by chance.
    expect_unbiased(judge(by_time, reference, scene), 1e-6);
}

// The same test sees the bias of the paper's sampler, and that it loses energy.
TEST(statistics, the_papers_sampler_is_biased) {
    const Device& device = test::devices().front();
    const test::TestScene scene = small("points");
    const Moments reference = render_seeds(device, scene, options_for("exhaustive", 1), 1);
    const Statistics s =
        judge(render_seeds(device, scene, options_for("contribution", 4), 120), reference, scene);
    EXPECT_LT(s.smallest_pixel, 1e-6);
    EXPECT_LT(s.mean, 1e-6);
    EXPECT_LT(s.bias, -0.001);
}

// Light samples and reflected rays together, against the exact image: with a lobe far narrower than
// a lamp, and with one about as wide. Here the paper's sampler is unbiased, too: nothing is hidden.
TEST(statistics, reflections_are_unbiased) {
    const test::TestScene scene = polished(0.08f, false);
    ASSERT_EQ(scene.scene.lights.size(), 3u);
    Moments exact;
    exact.add(luminances(exact_image(scene)));
    FOR_EACH_DEVICE(device)
    for (const Sampler& sampler : all_samplers()) {
        const bool judged = !sampler.closed_form.empty() || sampler.all_lights;
        if (!judged && sampler.name != "adaptive") continue;
        SCOPED_TRACE(sampler.name);
        // Of some lights more than one is expected, of others less; lightcuts have several rounds.
        const uint light_samples = sampler.name == "stochastic-lightcuts" ? 35 : 2;
        RenderOptions options = options_for(sampler.name, light_samples);
        options.hide_emitters = true;
        expect_unbiased(judge(render_seeds(device, scene, options, 100), exact, scene));
    }
}

// Lamps of many cells, a triangle among them, of which samplers favour some: against all cells,
// each with the one light sample that the shares are for.
TEST(statistics, reflections_of_many_cells_are_unbiased) {
    const test::TestScene scene = test::make_scene(
        [](GltfWriter& out) {
            Mesh floor;
            floor.add_quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4});
            out.add_mesh("floor", floor, out.add_material({0.8f, 0.7f, 0.6f}, 1, 0.14f));
            Mesh lamps;
            lamps.add_quad({-1, 0.3f, -1}, {0.9f, 0, 0}, {0, 0.8f, 0.1f});
            lamps.add_triangle({0.2f, 0.2f, -0.8f}, {1.2f, 0.2f, -1}, {0.5f, 1.2f, -0.9f});
            out.add_mesh("lamps", lamps, out.add_emitter({6, 5, 4}));
            out.add_camera("front", {0, 0.8f, 1.4f}, {0, 0, -0.2f}, 0.7f, 1.6f);
        },
        16, 10);
    ASSERT_GT(scene.scene.lights.size(), 70u);
    const Device& device = test::devices().front();
    RenderOptions options = options_for("exhaustive", 1);
    options.hide_emitters = true;
    const Moments all = render_seeds(device, scene, options, 150);
    for (const Sampler& sampler : all_samplers()) {
        if (sampler.closed_form.empty()) continue;
        SCOPED_TRACE(sampler.name);
        options.sampler = sampler.name;
        options.light_samples = sampler.name == "stochastic-lightcuts" ? 35 : 4;
        expect_unbiased(judge(render_seeds(device, scene, options, 150), all, scene));
    }
}

// Where light samples alone make fireflies.
TEST(statistics, reflections_lower_the_variance) {
    const test::TestScene scene = polished(0.04f, false);
    const Device& device = test::devices().front();
    double variance[2] = {};
    for (const bool reflections : {false, true}) {
        RenderOptions options = options_for("lighttree", 4);
        options.hide_emitters = true;
        options.reflections = reflections;
        const Moments found = render_seeds(device, scene, options, 20);
        for (std::size_t i = 0; i + 1 < found.sum.size(); ++i)
            variance[reflections] += found.variance(i);
    }
    EXPECT_LT(variance[1], variance[0] / 4);
}

// The same against light samples alone where something is in between, and normals are smooth.
TEST(statistics, reflections_are_hidden_as_lights_are) {
    const test::TestScene scene = polished(0.16f, true);
    const Device& device = test::devices().front();
    RenderOptions options = options_for("exhaustive", 1);
    options.hide_emitters = true;
    options.reflections = false;
    const Moments alone = render_seeds(device, scene, options, 150);
    options.reflections = true;
    for (const char* sampler : {"adaptive", "uniform", "lighttree", "contribution-defensive"}) {
        SCOPED_TRACE(sampler);
        options.sampler = sampler;
        options.light_samples = 2;
        expect_unbiased(judge(render_seeds(device, scene, options, 120), alone, scene));
    }
}

// Jittered pixel samples estimate the same image whatever the light sampler.
TEST(statistics, jittered_samples_are_unbiased) {
    const Device& device = test::devices().front();
    const test::TestScene scene = small("oriented");
    RenderOptions exhaustive = options_for("exhaustive", 1);
    exhaustive.spp = 64;
    exhaustive.pixel_centre = false;
    RenderOptions defensive = options_for("contribution-defensive", 2);
    defensive.spp = 3;
    defensive.pixel_centre = false;
    expect_unbiased(judge(render_seeds(device, scene, defensive, 120),
                          render_seeds(device, scene, exhaustive, 20), scene));
}

// A leaf that covers half a pixel of an empty image: what the first pixel sample of a tile misses,
// later ones may hit.
TEST(statistics, tiles_that_are_missed_first_are_seen_later) {
    const test::TestScene scene = test::make_scene(
        [](GltfWriter& out) {
            Mesh leaf;
            leaf.add_quad({0.2f, 0, 0}, {0.5f, 0, 0}, {0, 1, 0});
            out.add_mesh("leaf", leaf, out.add_diffuse(glm::vec3(0.5f)));
            for (int i = 0; i < 300; ++i)
                out.add_point({std::sin(i), 1 + std::cos(i), 1 + 0.01f * i}, glm::vec3(1));
            out.add_camera("front", {0.5f, 0.5f, 10}, {0.5f, 0.5f, 0}, 0.1f, 1);
        },
        1, 1);
    const Device& device = test::devices().front();
    RenderOptions options = options_for("lighttree", 4);
    options.pixel_centre = false;
    const Moments other = render_seeds(device, scene, options, 600);
    options.sampler = "adaptive";
    expect_unbiased(judge(render_seeds(device, scene, options, 600), other, scene));
}

}  // namespace manylight
