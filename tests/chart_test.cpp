// SPDX-License-Identifier: MIT
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "chart/folder.hpp"
#include "chart/report.hpp"
#include "error.hpp"
#include "output/hash.hpp"
#include "support.hpp"

namespace manylight {
namespace {

namespace fs = std::filesystem;

Image constant(unsigned width, unsigned height, float value) {
    Image image(width, height, {"R", "G", "B"});
    std::ranges::fill(image.values, value);
    return image;
}

void write_text(const fs::path& path, const std::string& text) { std::ofstream(path) << text; }

std::vector<std::string> names_in(const fs::path& folder) {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder))
        names.push_back(entry.path().filename().string());
    std::ranges::sort(names);
    return names;
}

// A run of one setting with the given time and error.
manylight::Run run_of(const Setting& setting, uint seed, double seconds, double error) {
    manylight::Run run;
    run.setting = setting;
    run.seed = seed;
    run.rendering.render_seconds = seconds;
    run.difference.relmse = error;
    return run;
}

// A chart of runs of 2 x 2 pixels that lacks all that summaries do not need.
Chart chart_of(std::vector<Setting> settings, std::vector<manylight::Run> runs, bool exact) {
    return {.options = {},
            .settings = std::move(settings),
            .left_out = {},
            .runs = std::move(runs),
            .images = {},
            .compile_seconds = {},
            .reference = Reference(2, 2, exact),
            .reference_setting = {},
            .reference_file = {}};
}

double relmse_of(const manylight::Run& run) { return run.difference.relmse; }

}  // namespace

TEST(chart, means_and_ratios) {
    const Mean mean = mean_of({1, 2, 3, 6});
    EXPECT_DOUBLE_EQ(mean.value, 3);
    EXPECT_NEAR(*mean.standard_error, std::sqrt(14. / 3 / 4), 1e-12);
    EXPECT_FALSE(mean_of({5}).standard_error);
    const Ratio ratio = ratio_of({1, 4});
    EXPECT_NEAR(ratio.value, 2, 1e-12);
    EXPECT_NEAR(*ratio.upper / ratio.value, std::exp(12.706 * std::log(2)), 1);
    EXPECT_NEAR(*ratio.upper * *ratio.lower, 4, 1e-9);
    EXPECT_FALSE(ratio_of({3}).lower);
}

// A table's: NIST/SEMATECH, "e-Handbook of Statistical Methods", 1.3.6.7.2.
TEST(chart, student_quantiles) {
    EXPECT_NEAR(student_quantile(1), 12.706, 0.0005);
    EXPECT_NEAR(student_quantile(4), 2.776, 0.0005);
    EXPECT_NEAR(student_quantile(5), 2.571, 0.0005);
    EXPECT_NEAR(student_quantile(9), 2.262, 0.0005);
    EXPECT_NEAR(student_quantile(100), 1.984, 0.0005);
}

TEST(chart, packed_images_keep_what_is_large) {
    Image image(3, 2, {"R", "G", "B"});
    image.values = {1,      0.5f, 0.001f, 3e-5f, 2e-5f, 1e-5f, 70000, 3, 0,
                    0.999f, 0,    0,      -1,    0.5f,  0,     NAN,   0, 0};
    const PackedImage packed = pack(image);
    const std::size_t first[] = {128, 64, 0, 129, 0};  // of the first pixel, times 2^(129 - 136)
    for (std::size_t plane = 0; plane < 5; ++plane)
        EXPECT_EQ(packed.planes[plane * 6], first[plane]) << plane;
    const Image back = unpack(packed);
    for (std::size_t pixel = 0; pixel < 5; ++pixel) {
        const float* p = image.values.data() + 3 * pixel;
        const float largest = std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])});
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(back.values[3 * pixel + c], p[c], largest / 256) << pixel;
    }
    for (std::size_t i = 15; i < 18; ++i) EXPECT_EQ(back.values[i], 0);
    EXPECT_TRUE(data_uri(packed).starts_with("data:image/png;base64,iVBOR"));
}

TEST(chart, hashes_tell_contents_apart) {
    const auto name = [](auto... parts) {
        ContentHash hash;
        (hash.add(std::string_view(parts)), ...);
        return hash.name();
    };
    EXPECT_EQ(name("a", "b"), name("a", "b"));
    EXPECT_NE(name("a", "b"), name("ab"));
    EXPECT_NE(name("a", "b"), name("b", "a"));
    EXPECT_NE(name("a", ""), name("a"));
}

// Noise of known variance: the error that it reports is the one that it has.
TEST(chart, reference_knows_its_error) {
    std::mt19937 random(1);
    std::normal_distribution<float> noise(0, 0.3f);
    Reference reference(60, 50, false);
    for (int i = 0; i < 8; ++i) {
        Image image = constant(60, 50, 1);
        for (float& v : image.values) v += noise(random);
        reference.add(image, 2);
    }
    EXPECT_EQ(reference.count(), 8u);
    EXPECT_EQ(reference.seconds(), 16);
    const double truth =
        compare_images(reference.image(), constant(60, 50, 1), "the reference", "truth").relmse;
    EXPECT_NEAR(truth, 0.25 * 0.09 / 8 / 0.26, 3e-4);
    EXPECT_NEAR(reference.error().relmse / truth, 1, 0.05);
    const double weights = std::sqrt(0.2126 * 0.2126 + 0.7152 * 0.7152 + 0.0722 * 0.0722);
    EXPECT_NEAR(*reference.luminance().standard_error / (0.3 * weights / std::sqrt(8 * 3000)), 1,
                0.6);
    Reference exact(60, 50, true);
    exact.add(constant(60, 50, 1), 1);
    EXPECT_EQ(exact.error().relmse, 0);
    EXPECT_EQ(exact.luminance().standard_error, 0);
}

// Saved and loaded, it goes on as if nothing had happened.
TEST(chart, references_go_on_from_a_file) {
    const std::string path = test::temporary("reference.exr");
    std::mt19937 random(1);
    std::uniform_real_distribution<float> noise(0, 2);
    Reference whole(9, 7, false);
    Reference resumed(9, 7, false);
    for (int i = 0; i < 6; ++i) {
        Image image = constant(9, 7, 1);
        for (float& v : image.values) v *= noise(random);
        whole.add(image, 1);
        resumed.add(image, 1);
        resumed.save(path, "key");
        resumed = Reference::load(path, "key", 9, 7, false);
    }
    EXPECT_EQ(resumed.count(), 6u);
    EXPECT_EQ(resumed.seconds(), 6);
    EXPECT_EQ(resumed.luminance().value, whole.luminance().value);
    EXPECT_NEAR(resumed.error().relmse / whole.error().relmse, 1, 1e-5);
    for (std::size_t i = 0; i < 9 * 7 * 3; ++i)
        EXPECT_NEAR(resumed.image().values[i], whole.image().values[i], 1e-6);
    EXPECT_THROW((void)Reference::load(path, "other", 9, 7, false), InputError);
    EXPECT_THROW((void)Reference::load(path, "key", 7, 9, false), InputError);
    write_exr(path, {constant(9, 7, 1)}, {});
    EXPECT_THROW((void)Reference::load(path, "key", 9, 7, false), InputError);
}

TEST(chart, errors_are_read_between_runs) {
    // relMSE = 1 / seconds, and a run that a faster one is better than.
    const std::vector<std::pair<double, double>> points = {
        {4, 0.25}, {1, 1}, {2, 3}, {16, 1. / 16}};
    EXPECT_NEAR(*error_at(points, 8), 1. / 8, 1e-12);
    EXPECT_NEAR(*error_at(points, 2), 1. / 2, 1e-12);
    EXPECT_EQ(*error_at(points, 1), 1);
    EXPECT_EQ(*error_at(points, 16), 1. / 16);
    EXPECT_FALSE(error_at(points, 0.9));
    EXPECT_FALSE(error_at(points, 16.1));
    EXPECT_EQ(*error_at({{1, 1}, {3, 2}}, 2), 1);  // no better than what is done by then
}

TEST(chart, ratios_of_methods) {
    const Setting one{"power", 1, 1};
    const Setting four{"power", 4, 1};
    const Setting base{"adaptive", 1, 1};
    std::vector<manylight::Run> runs;
    for (const uint seed : {1, 2}) {
        const double error = seed;  // the second seed is twice as bad for all
        runs.push_back(run_of(one, seed, 1, 8 * error));
        runs.push_back(run_of(four, seed, 4, 2 * error));
        runs.push_back(run_of(base, seed, 2, error));
    }
    Chart chart = chart_of({one, four, base}, runs, true);
    chart.reference.add(constant(2, 2, 1), 1);
    for (manylight::Run& run : chart.runs) run.luminance = run.seed == 1 ? 1.01 : 1.03;
    const std::vector<SettingSummary> summaries = summarise(chart);
    ASSERT_EQ(summaries.size(), 3u);
    EXPECT_EQ(summaries[1].setting, four);
    EXPECT_EQ(summaries[1].relmse.median, 3);
    EXPECT_EQ(summaries[1].seconds.median, 4);
    EXPECT_NEAR(summaries[1].bias, 0.02, 1e-12);
    EXPECT_NEAR(*summaries[1].z, 2, 1e-9);
    EXPECT_NEAR(equal_samples(summaries[0], summaries[2], relmse_of)->value, 8, 1e-12);
    EXPECT_NEAR(*equal_samples(summaries[0], summaries[2], relmse_of)->upper, 8, 1e-9);
    const std::vector<const SettingSummary*> ladder = {&summaries[0], &summaries[1]};
    EXPECT_NEAR(equal_time(ladder, summaries[2], relmse_of)->value, 4, 1e-12);
    for (manylight::Run& run : chart.runs)
        if (run.setting == base) run.rendering.render_seconds = 5;
    EXPECT_FALSE(equal_time(ladder, summarise(chart)[2], relmse_of));
}

// The reference's own variance is part of a bias's.
TEST(chart, biases_count_the_references_error) {
    const Setting setting{"power", 1, 1};
    Chart chart =
        chart_of({setting}, {run_of(setting, 1, 1, 0.1), run_of(setting, 2, 1, 0.1)}, false);
    for (const float value : {0.9f, 1.1f}) chart.reference.add(constant(2, 2, value), 1);
    for (manylight::Run& run : chart.runs) run.luminance = 1.2;
    const SettingSummary summary = summarise(chart)[0];
    EXPECT_NEAR(summary.bias, 0.2, 1e-6);
    EXPECT_NEAR(*summary.bias_error, 0.1, 1e-6);
    EXPECT_NEAR(*summary.z, 2, 1e-5);
    EXPECT_TRUE(summary.limited);  // 0.005 / 0.26 is not 100 times below 0.1
}

// Only what a chart wrote is ever replaced.
TEST(chart, folders_keep_what_is_no_chart) {
    const fs::path around = test::temporary("charts");
    fs::create_directories(around);
    const std::string folder = (around / "a").string();
    const auto fill = [](const std::string& text) {
        return [text](const std::string& to) {
            write_text(fs::path(to) / "chart.json",
                       R"({"files": ["chart.json", ")" + text + "\"]}");
            write_text(fs::path(to) / text, text);
        };
    };
    EXPECT_NO_THROW(check_chart_folder("-o", folder));
    write_chart_folder(folder, fill("old"));
    EXPECT_EQ(names_in(folder), (std::vector<std::string>{"chart.json", "old"}));
    EXPECT_NO_THROW(check_chart_folder("-o", folder + "/"));
    write_chart_folder(folder, fill("new"));
    EXPECT_EQ(names_in(folder), (std::vector<std::string>{"chart.json", "new"}));
    EXPECT_THROW(write_chart_folder(folder,
                                    [](const std::string& to) {
                                        write_text(fs::path(to) / "half", "");
                                        throw RuntimeError("the disk is full");
                                    }),
                 RuntimeError);
    EXPECT_EQ(names_in(folder), (std::vector<std::string>{"chart.json", "new"}));
    EXPECT_EQ(names_in(around), (std::vector<std::string>{"a"}));
    write_text(fs::path(folder) / "notes.txt", "mine");
    EXPECT_THROW(check_chart_folder("-o", folder), InputError);
    EXPECT_THROW(write_chart_folder(folder, fill("newer")), InputError);
    EXPECT_EQ(names_in(folder), (std::vector<std::string>{"chart.json", "new", "notes.txt"}));
    EXPECT_THROW(check_chart_folder("-o", (around / "none" / "a").string()), InputError);
    EXPECT_THROW(check_chart_folder("-o", (fs::path(folder) / "new").string()), InputError);
    EXPECT_THROW(check_chart_folder("-o", ""), InputError);
}

// What is in it is inside script elements, which "</" would end.
TEST(chart, reports_hold_any_text) {
    const nlohmann::json chart = {{"scene", {{"file", "</script><b>&\"'\xff.glb"}}}};
    const std::string report = make_report(chart, constant(4, 4, 1), {});
    EXPECT_EQ(report.find("</script><b>"), std::string::npos);
    EXPECT_NE(report.find(R"(\u003c/script>\u003cb>&\"')"), std::string::npos);
    EXPECT_EQ(report.find("{{"), std::string::npos);
    EXPECT_NE(report.find("Chart.js v"), std::string::npos);
    EXPECT_EQ(report.find("src=\"http"), std::string::npos);
}

// Noise does not compress: 12 MB of it are shown at half the size.
TEST(chart, reports_stay_small) {
    Image noise(2000, 1600, {"R", "G", "B"});
    std::mt19937 random(1);
    std::uniform_real_distribution<float> value(0.5f, 1);
    for (float& v : noise.values) v = value(random);
    const std::string report = make_report({}, noise, {});
    EXPECT_LT(report.size(), 15'000'000u);
    EXPECT_NE(report.find(R"("smaller_by":2)"), std::string::npos);
    EXPECT_NE(report.find(R"("width":1000)"), std::string::npos);
}

}  // namespace manylight
