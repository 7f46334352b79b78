// SPDX-License-Identifier: MIT
// The table of stages: what `verify` selects of it, and the commands that repeat what fails.
#include <fstream>
#include <iterator>
#include <sstream>

#include "commands/options/commands.hpp"
#include "commands/verify_report.hpp"
#include "support.hpp"
#include "verify/sampler_checks.hpp"
#include "verify/scenes.hpp"
#include "verify/stages.hpp"

namespace manylight {
namespace {

VerifyOptions small_options() {
    VerifyOptions options;
    options.width = 40;
    options.height = 34;
    options.most_entries = 3'000;
    return options;
}

// The first scene on a device that has other lights than the reference: by a thousandth brighter.
Verification of_wrong_device(const VerifyOptions& options) {
    const Device& device = test::devices().back();
    VerifyScene made = std::move(verify_scenes().front());
    Verifier verifier(device, made.scene, make_camera(made.view, options.width, options.height),
                      options);
    for (Light& light : made.scene.lights) light.emission *= float4(1.001f, 1.001f, 1.001f, 1);
    Verification found{{}, Coverage(device.form().lanes > 1), true, options.only};
    found.scenes.push_back(
        {made.name, "", 0, 0, options.width, options.height, verifier.all(), made.name});
    return found;
}

TEST(verify_stages, tells_a_wrong_device) {
    const Verification found = of_wrong_device(small_options());
    std::set<std::string> failed;
    for (const Check& check : found.scenes[0].checks)
        if (!check.passed()) failed.insert(check.stage);
    for (const Sampler& s : all_samplers())
        if (checks_of(s).reference != nullptr) {
            EXPECT_TRUE(failed.contains(fmt::format("samples ({})", s.name))) << s.name;
        }
    EXPECT_TRUE(failed.contains("contributions"));
    EXPECT_FALSE(failed.contains("gbuffer"));
    EXPECT_EQ(found.verdict(), "The device does NOT compute correctly.");
}

std::vector<std::string> printed_commands(const Verification& found,
                                          const VerifyArguments& arguments) {
    testing::internal::CaptureStdout();
    print_table(found, arguments);
    std::istringstream table(testing::internal::GetCapturedStdout());
    const std::string before = "    to repeat it: manylight verify ";
    std::vector<std::string> commands;
    for (std::string line; std::getline(table, line);)
        if (line.starts_with(before)) commands.push_back(line.substr(before.size()));
    return commands;
}

// Each command that is printed below a failure, taken as the program takes it, has that failure
// again, and it alone.
TEST(verify_stages, commands_repeat_failures) {
    VerifyOptions options = small_options();
    options.seed = 7;
    options.clusters.tile_size = 16;
    options.only.stages = {"gbuffer", "contributions", "samples"};
    const Verification found = of_wrong_device(options);
    VerifyArguments arguments;
    arguments.scene.device = "0";
    arguments.scene.lanes = test::devices().back().form().lanes;
    arguments.scene.width = options.width;
    arguments.scene.height = options.height;
    arguments.seed = options.seed;
    arguments.clusters = options.clusters;
    std::vector<const Check*> failures;
    for (const Check& check : found.scenes[0].checks)
        if (!check.passed()) failures.push_back(&check);
    const std::vector<std::string> commands = printed_commands(found, arguments);
    ASSERT_GT(commands.size(), all_samplers().size() / 2);
    ASSERT_EQ(commands.size(), failures.size());
    for (std::size_t i = 0; i < commands.size(); ++i) {
        SCOPED_TRACE(commands[i]);
        CLI::App app;
        VerifyArguments taken;
        options::add_verify_options(app, taken);
        app.parse(commands[i]);
        EXPECT_EQ(taken.only.scenes, std::vector<std::string>{found.scenes[0].name});
        EXPECT_EQ(std::tuple(taken.scene.device, taken.scene.lanes),
                  std::tuple(arguments.scene.device, arguments.scene.lanes));
        VerifyOptions again = small_options();
        again.width = taken.scene.width;
        again.height = taken.scene.height;
        again.seed = taken.seed;
        again.clusters = taken.clusters;
        again.only = taken.only;
        const Verification repeated = of_wrong_device(again);
        ASSERT_EQ(repeated.scenes[0].checks.size(), 1u);
        const Check& check = repeated.scenes[0].checks[0];
        EXPECT_EQ(check.stage, failures[i]->stage);
        EXPECT_EQ(check.failed, failures[i]->failed);
        EXPECT_EQ(check.first_failure, failures[i]->first_failure);
    }
}

// Of a file: with what shows it.
TEST(verify_stages, commands_show_the_same) {
    VerifyArguments arguments;
    arguments.scene.file = "two rooms.glb";
    arguments.scene.camera = "door";
    arguments.scene.device = "intel";
    arguments.scene.lanes = 1;
    arguments.scene.threads = 2;
    arguments.scene.width = 96;
    arguments.scene.height = 54;
    arguments.clusters.normal_threshold = 12.5f;
    EXPECT_EQ(repeat_command(arguments, {}, {.stage = "gbuffer (jittered)", .tolerance = ""}),
              "manylight verify 'two rooms.glb' --camera door --device intel --device-form gpu "
              "--threads 2 --width 96 --height 54 --seed 1 --normal-threshold 12.5 --stage "
              "gbuffer");
}

std::set<std::string> stages_in(const std::vector<Check>& checks) {
    std::set<std::string> stages;
    for (const Check& check : checks) stages.insert(stage_of(check));
    return stages;
}

// By what a row says of itself it is selected.
TEST(verify_stages, rows_name_their_stages) {
    Verifier& verifier = test::verifier("kinds", test::devices().back());
    for (const StageCheck& row : all_stages())
        EXPECT_EQ(stages_in(row.run(verifier)),
                  std::set<std::string>(row.stages.begin(), row.stages.end()));
    for (const Sampler& sampler : all_samplers()) {
        const SamplerChecks& row = checks_of(sampler);
        EXPECT_EQ(stages_in(row.run(verifier, sampler)),
                  std::set<std::string>(row.stages.begin(), row.stages.end()))
            << sampler.name;
    }
}

TEST(verify_stages, selects_stages) {
    const VerifyScene made = std::move(verify_scenes().front());
    const auto checks = [&](const Selection& only) {
        VerifyOptions options = small_options();
        options.only = only;
        Verifier verifier(test::devices().back(), made.scene,
                          make_camera(made.view, options.width, options.height), options);
        std::vector<std::string> names;
        for (const Check& check : verifier.all()) names.push_back(check.stage);
        return names;
    };
    using Names = std::vector<std::string>;
    EXPECT_EQ(checks({{"gbuffer", "layout"}, {}, {}}),
              (Names{"layout", "gbuffer", "gbuffer (jittered)"}));
    EXPECT_EQ(checks({{"weights"}, {}, {}}), (Names{"weights"}));
    EXPECT_EQ(checks({{}, {"power"}, {}}), (Names{"pdf (power)", "samples (power)"}));
    EXPECT_EQ(checks({{"layout", "samples"}, {"power", "ris"}, {}}),
              (Names{"layout", "samples (power)", "samples (ris)"}));
    const auto visited = [](const Selection& only) {
        VerifyOptions options = small_options();
        options.only = only;
        const Verification found =
            verify_all(test::devices().back(), options, [](double /*share*/) {});
        EXPECT_NE(found.verdict().find("what was selected. Not tested:"), std::string::npos);
        EXPECT_NE(found.verdict().find(only.words()), std::string::npos);
        std::vector<std::string> names;
        for (const SceneChecks& scene : found.scenes) names.push_back(scene.name);
        return names;
    };
    EXPECT_EQ(
        visited({{"reflections"}, {}, {"mirrors"}}),
        (Names{"mirrors", "mirrors, orthographic", "mirrors, receivers that no camera sees"}));
    EXPECT_EQ(visited({{"random"}, {}, {"mirrors", "veil"}}), (Names{"mirrors"}));
    EXPECT_EQ(visited({{"gbuffer"}, {}, {"veil"}}), (Names{"veil"}));
}

TEST(verify_stages, documents_name_every_stage) {
    std::ifstream file(MANYLIGHT_DOCS "/verify.md");
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    for (const std::string_view stage : stage_names())
        EXPECT_NE(text.find(fmt::format("`{}`", stage)), std::string::npos) << stage;
}

}  // namespace
}  // namespace manylight
