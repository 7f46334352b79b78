// SPDX-License-Identifier: MIT
// The failure atlas (docs/atlas.md) in small: each sampler at a middle and at a hard value of every
// sweep. On one device: what others do differently, the tests of stages see.
#include <cmath>
#include <fstream>

#include "chart/reference.hpp"
#include "output/metrics.hpp"
#include "scene/builtin/builtin.hpp"
#include "scene/gltf/load.hpp"
#include "support.hpp"

namespace manylight {
namespace {

// A view of a built-in scene that is quick to render again and again.
class Point {
  public:
    Point(std::string name, const std::string& scene, const BuiltinOptions& options,
          uint light_samples = 4, unsigned width = 24, unsigned height = 14, double shift = 0)
        : name(std::move(name)), light_samples(light_samples), scene_(load(scene, options)) {
        const unsigned lanes = test::devices().front().form().bvh_width;
        const Camera camera = make_camera(find_view(scene_, ""), width, height, {shift, shift});
        bvh_ = build_wide_bvh(scene_, lanes, lanes, reach_of(scene_, camera));
        renderer_ = std::make_unique<Renderer>(test::devices().front(), scene_, bvh_, camera, width,
                                               height, 0);
    }

    Point(const Point&) = delete;  // what renders it refers to its members
    Point& operator=(const Point&) = delete;

    [[nodiscard]] std::vector<Image> render(std::string_view sampler, uint spp, uint seeds) const {
        std::vector<Image> out;
        for (uint seed = 1; seed <= seeds; ++seed) out.push_back(render_one(sampler, spp, seed));
        return out;
    }

    // Of all lights: one where they are points, and so it is exact.
    [[nodiscard]] std::vector<Image> references() const {
        if (is_exact()) return render("exhaustive", 1, 1);
        const std::size_t all = lights() * renderer_->width() * renderer_->height();
        return render("exhaustive", std::clamp(6'000'000 / static_cast<uint>(all), 1u, 64u), 8);
    }

    [[nodiscard]] bool is_exact() const { return renderer_->is_exact(find_sampler("exhaustive")); }
    [[nodiscard]] std::size_t lights() const { return scene_.lights.size(); }

    std::string name;
    uint light_samples;
    bool hard = false;

  private:
    static Scene load(const std::string& name, const BuiltinOptions& options) {
        const std::string path = test::temporary("stability.glb");
        make_builtin(name, options).write(path);
        Scene scene = load_scene(path);
        add_emitters(scene, scene.emitter_points.value_or(0));
        return scene;
    }

    [[nodiscard]] Image render_one(std::string_view sampler, uint spp, uint seed) const {
        Progress quiet("", true);
        return renderer_->render({std::string(sampler), light_samples, spp}, seed, quiet).image;
    }

    Scene scene_;
    WideBvh bvh_;
    std::unique_ptr<Renderer> renderer_;
};

constexpr std::size_t most_lights = 20'000;  // more are too slow to be drawn all

// The value in the middle of a sweep, and the last but one, or the last before it that has few
// enough lights.
std::vector<std::unique_ptr<Point>> points_of(const Builtin& scene,
                                              const SceneParameter& parameter) {
    std::vector<std::unique_ptr<Point>> out;
    const std::size_t count = parameter.sweep.size();
    for (std::size_t i : {(count - 1) / 2, count - 2})
        while (true) {
            const double value = parameter.sweep[i--];
            const BuiltinOptions options{.values = {{std::string(parameter.name), value}}};
            auto point = std::make_unique<Point>(
                fmt::format("{} --{} {}", scene.name, parameter.name, value),
                std::string(scene.name), options);
            if (point->lights() > most_lights) continue;
            point->hard = !out.empty();
            out.push_back(std::move(point));
            break;
        }
    return out;
}

// What images of one setting, of several seeds, say of a sampler.
class Runs {
  public:
    // `own_error`: relMSE of the reference, which adds to what is found.
    Runs(const std::vector<Image>& images, const Image& reference, double own_error) {
        for (const Image& image : images) {
            const Difference d = compare_images(image, reference, "image", "reference");
            bad += d.bad;
            negative += std::ranges::count_if(image.values, [](float v) { return v < 0; });
            errors_.push_back(std::max(d.relmse - own_error, 1e-12));
            add_parts(image, reference);
        }
    }

    // The mean relMSE, with its standard error.
    [[nodiscard]] Mean error() const { return mean_of(errors_); }

    // The smallest probability that a part's mean is as far from the reference's by chance, times
    // the number of parts. A part's variance is its own or that of all, whichever is larger: few
    // seeds may not have met what is rare.
    [[nodiscard]] double probability(const Runs& reference) const {
        double variance = 0;
        for (std::size_t i = 0; i < parts; ++i) variance += variance_of(i) / parts;
        double smallest = 1;
        for (std::size_t i = 0; i < parts; ++i) {
            const double expected = mean_of(reference.parts_[i]).value;
            const double difference = mean_of(parts_[i]).value - expected;
            const double rounding = 1e-6 * expected + 1e-9;
            if (std::abs(difference) <= rounding) continue;
            const double all = std::max(variance_of(i), variance) + reference.variance_of(i);
            const double t = difference / std::max(std::sqrt(all), rounding);
            const auto freedom = static_cast<double>(errors_.size() - 1);
            smallest = std::min(smallest, parts * test::student_tail(t, freedom));
        }
        return smallest;
    }

    std::size_t bad = 0;       // values that are no finite numbers
    std::size_t negative = 0;  // values

  private:
    static constexpr std::size_t parts = 4;  // quarters of the image

    // Pixels count relative to what they should be, so that a few bright ones, which few seeds
    // meet, are not all that counts.
    void add_parts(const Image& image, const Image& reference) {
        const double floor = 0.1 * mean_luminance(reference);
        double sums[parts] = {};
        for (std::size_t i = 0; i < image.pixel_count(); ++i) {
            const std::size_t right = 2 * (i % image.width) / image.width;
            const std::size_t lower = 2 * (i / image.width) / image.height;
            sums[2 * lower + right] +=
                luminance_of(image, i) / (luminance_of(reference, i) + floor);
        }
        for (std::size_t i = 0; i < parts; ++i) parts_[i].push_back(sums[i]);
    }

    static double luminance_of(const Image& image, std::size_t pixel) {
        const float* p = image.values.data() + 3 * pixel;
        return luminance(glm::vec3(p[0], p[1], p[2]));
    }

    // Of a part's mean.
    [[nodiscard]] double variance_of(std::size_t part) const {
        const double error = mean_of(parts_[part]).standard_error.value_or(0);
        return error * error;
    }

    std::vector<double> errors_;
    std::vector<double> parts_[parts];  // [part][image] sum over its pixels
};

// The relMSE of some images with a number of pixel samples.
struct Step {
    uint spp, images;
    Mean error;

    // Of an image; 0 where there is only one.
    [[nodiscard]] double relative_deviation() const {
        return error.standard_error.value_or(0) * std::sqrt(images) / error.value;
    }
};

// The slope of log error against log pixel samples, by least squares. Few images do not tell their
// own deviation: the largest relative one of all steps is taken for each. None where it is so large
// that few images may not have met the largest errors.
std::optional<Mean> slope_of(const std::vector<Step>& steps) {
    constexpr double exact = 1e-10;  // errors of rounding, which do not fall
    double deviation = 0;
    for (const Step& s : steps)
        if (s.error.value < exact) return {};
    for (const Step& s : steps) deviation = std::max(deviation, s.relative_deviation());
    if (steps.size() < 2 || deviation > 0.5) return {};
    double images = 0;
    double x_mean = 0;
    for (const Step& s : steps) images += s.images;
    for (const Step& s : steps) x_mean += s.images * std::log(s.spp) / images;
    double xx = 0;
    double xy = 0;
    for (const Step& s : steps) {
        const double x = std::log(s.spp) - x_mean;
        xx += s.images * x * x;
        xy += s.images * x * std::log(s.error.value);
    }
    return Mean{xy / xx, deviation / std::sqrt(xx)};
}

bool page_tells_of_negative_values(std::string_view sampler) {
    std::ifstream file(fmt::format("{}/samplers/{}.md", MANYLIGHT_DOCS, sampler));
    const std::string page(std::istreambuf_iterator<char>(file), {});
    EXPECT_FALSE(page.empty()) << sampler;
    return page.find("negative") != std::string::npos;
}

// Where sampler adaptive is worse than allowed, and how much; docs/atlas.md says why.
const std::map<std::string, double, std::less<>> exceptions = {{"glossy --roughness 0.03", 1.8},
                                                               {"stacks --stack 64", 7},
                                                               {"stacks --stack 512", 5},
                                                               {"1 light sample", 3}};
constexpr double most_ratio = 1.2;  // of adaptive's error to the best other's with as many rays

constexpr std::size_t few_lights = 200;

// Numbers of pixel samples, and of images with so many. At hard points only one: few images do not
// tell there how errors fall; nor with many lights, nor of samplers that trace all that they need,
// to save time.
std::vector<std::pair<uint, uint>> ladder_of(const Point& point, const Sampler& sampler) {
    if (point.hard || point.lights() > few_lights || sampler.own_rays) return {{4, 8}};
    return {{1, 4}, {4, 8}, {64, 1}};
}

struct Verdict {
    double error = 0;        // relMSE with 4 pixel samples
    double probability = 1;  // that its mean is as far from the reference's by chance
    std::optional<Mean> slope;
};

Verdict measure(const Point& point, const Sampler& sampler, const Image& truth, double own_error,
                const Runs& expected) {
    Verdict out;
    std::vector<Step> steps;
    for (const auto& [spp, seeds] : ladder_of(point, sampler)) {
        const Runs runs(point.render(sampler.name, spp, seeds), truth, own_error);
        EXPECT_EQ(runs.bad, 0u);
        if (runs.negative > 0) {
            EXPECT_TRUE(page_tells_of_negative_values(sampler.name));
        }
        steps.push_back({spp, seeds, runs.error()});
        if (spp != 4) continue;
        out.error = runs.error().value;
        out.probability = runs.probability(expected);
    }
    out.slope = slope_of(steps);
    return out;
}

// Whether a few images are black, or nearly so: in a vault, what does not know visibility hardly
// ever draws a lamp that shines.
bool hardly_lights(const Point& point, const Sampler& sampler) {
    return point.name.starts_with("vault") && !sampler.clusters && !sampler.own_rays &&
           sampler.name != "adaptive";
}

// Returns how unlikely the paper's sampler is, were it unbiased.
double judge(const Point& point) {
    SCOPED_TRACE(point.name);
    const std::vector<Image> references = point.references();
    Reference reference(references[0].width, references[0].height, point.is_exact());
    for (const Image& image : references) reference.add(image, 0);
    const double own_error = reference.error().relmse;
    const Image truth = reference.image();
    const Runs expected(references, truth, 0);
    double papers = 1;
    double adaptive = 0;
    double best = std::numeric_limits<double>::infinity();
    for (const Sampler& sampler : all_samplers()) {
        if (sampler.all_lights) continue;
        SCOPED_TRACE(sampler.name);
        const Verdict v = measure(point, sampler, truth, own_error, expected);
        if (sampler.name == "contribution") papers = v.probability;
        if (!sampler.biased && !hardly_lights(point, sampler)) {
            EXPECT_GT(v.probability, 1e-6);
        }
        if (v.slope && !sampler.biased) {
            // A tenth and four deviations: of hundreds of slopes, all of few images, none is
            // beyond.
            EXPECT_LT(v.slope->value - 4 * *v.slope->standard_error, -0.9);
        }
        if (sampler.name == "adaptive")
            adaptive = v.error;
        else if (!sampler.own_rays)
            best = std::min(best, v.error);
    }
    const auto exception = exceptions.find(point.name);
    EXPECT_LT(adaptive / best, exception == exceptions.end() ? most_ratio : exception->second);
    return papers;
}

// The part of an image from (x, y) on.
Image crop(const Image& image, unsigned x, unsigned y, unsigned width, unsigned height) {
    Image out(width, height, image.channels);
    for (unsigned row = 0; row < height; ++row)
        std::copy_n(image.values.begin() + 3 * (std::size_t{y + row} * image.width + x), 3 * width,
                    out.values.begin() + 3 * std::size_t{row} * width);
    return out;
}

}  // namespace

TEST(stability, every_sampler_on_every_sweep) {
    int points = 0;
    int seen = 0;  // where the test sees the paper's sampler's bias
    for (const Builtin& scene : all_builtins())
        for (const SceneParameter& parameter : scene.parameters)
            for (const auto& point : points_of(scene, parameter)) {
                ++points;
                if (judge(*point) < 1e-6) ++seen;
            }
    EXPECT_GT(seen, points / 3);
}

// Every built-in scene as it is usually, but for city's lights, of which there are too many.
TEST(stability, adaptive_is_unbiased_on_every_scene) {
    for (const Builtin& scene : all_builtins()) {
        BuiltinOptions options;
        if (scene.name == "city") options.values["lights"] = 10'000;
        Point point(std::string(scene.name), std::string(scene.name), options);
        const std::vector<Image> references = point.references();
        Reference reference(references[0].width, references[0].height, point.is_exact());
        for (const Image& image : references) reference.add(image, 0);
        const Image truth = reference.image();
        const Runs expected(references, truth, 0);
        for (const uint light_samples : {1u, 4u, 16u}) {
            point.light_samples = light_samples;
            const Runs runs(point.render("adaptive", 2, 16), truth, 0);
            EXPECT_GT(runs.probability(expected), 1e-6)
                << scene.name << ", " << light_samples << " light samples";
        }
    }
}

// Difficulties that are not the scene's: few and many light samples, images of one pixel and of an
// odd size.
TEST(stability, every_sampler_at_odd_settings) {
    judge(Point("1 light sample", "blinds", {}, 1, 48, 28));
    judge(Point("16 light samples", "blinds", {}, 16));
    Point beam("pinhole --hole 0.2", "pinhole", {.values = {{"hole", 0.2}}});
    beam.hard = true;  // fireflies at the beam's edge
    judge(beam);
    judge(Point("1 x 1", "range", {}, 4, 1, 1));
    judge(Point("33 x 17", "range", {}, 4, 33, 17));
}

// The same part of the scene, wherever the borders of tiles fall in it. Others make fireflies,
// which few images do not meet alike.
TEST(stability, results_do_not_jump_with_tile_alignment) {
    constexpr unsigned border = 32;
    constexpr unsigned width = 40;
    constexpr unsigned height = 24;
    std::map<std::string_view, std::pair<double, double>> extremes;
    Image unshifted;
    for (const unsigned shift : {0u, 7u, 16u, 31u}) {
        const Point point("", "range", {}, 4, border + width, border + height, shift);
        const auto part = [&](const Image& image) {
            return crop(image, border - shift, border - shift, width, height);
        };
        const Image truth = part(point.references().front());
        if (shift == 0) unshifted = truth;
        EXPECT_LT(compare_images(truth, unshifted, "shifted", "unshifted").relmse, 1e-4);
        for (const std::string_view sampler : {"uniform", "ris", "lighttree", "adaptive"}) {
            double error = 0;
            for (const Image& image : point.render(sampler, 4, 6))
                error += compare_images(part(image), truth, "image", "reference").relmse / 6;
            auto& [least, most] = extremes.try_emplace(sampler, error, error).first->second;
            least = std::min(least, error);
            most = std::max(most, error);
        }
    }
    for (const auto& [sampler, e] : extremes) EXPECT_LT(e.second / e.first, 1.5) << sampler;
}

}  // namespace manylight
