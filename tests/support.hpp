// SPDX-License-Identifier: MIT
// Small scenes, all devices, and statistics for the tests.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pipeline/frame.hpp"
#include "scene/gltf/writer.hpp"
#include "verify/verify.hpp"

namespace manylight::test {

/// Every usable OpenCL device of the machine, opened once for the whole process.
[[nodiscard]] const std::vector<Device>& devices();

/// A name for a device that a test's name may contain.
[[nodiscard]] std::string label(const Device& device);

/// A scene with its lights and a camera of a given size.
struct TestScene {
    Scene scene;
    Camera camera;
    unsigned width, height;
};

/// Writes a scene to a file, loads it back and completes its lights; `emitter_points` as for
/// add_emitters().
[[nodiscard]] TestScene make_scene(const std::function<void(GltfWriter&)>& fill,
                                   unsigned width = 64, unsigned height = 40,
                                   unsigned emitter_points = 0);

/// Test scenes by name:
/// points    Lambert's room with two boxes and 24 point lights, some behind a wall
/// kinds     GGX and Lambert, a smooth ball, and lights of every kind, some with a range
/// oriented  an emitter as 16 oriented points, boxes, and a background that rays miss
/// many      700 point lights, most of them outside a box
[[nodiscard]] const TestScene& scene_named(const std::string& name);
[[nodiscard]] const std::vector<std::string>& scene_names();

/// The verifier of a scene on a device, built once.
[[nodiscard]] Verifier& verifier(const std::string& scene, const Device& device);

/// Expects a check to pass; the message tells the first failure.
void expect_pass(const Check& check);

/// Expects all checks of a stage to pass, of which there are some.
void expect_stage(const std::string& stage, Verifier& verifier);

/// Renders a test scene; options' size is the scene's.
[[nodiscard]] FrameResult render(const Device& device, const TestScene& scene,
                                 RenderOptions options);

/// A path for a file of this test process that is removed at its end.
[[nodiscard]] std::string temporary(const std::string& name);

/// The probability that a chi-squared variable of k > 0 degrees of freedom exceeds x, at least 0.
[[nodiscard]] double chi_squared_tail(double x, double k);

/// The two-sided probability that Student's t with k > 0 degrees of freedom exceeds |t| in size.
[[nodiscard]] double student_tail(double t, double k);

/// Runs a test body for every device, naming the device in failures.
#define FOR_EACH_DEVICE(device)                                                       \
    for (const Device& device : test::devices())                                      \
        for (testing::ScopedTrace on_device(__FILE__, __LINE__, test::label(device)), \
             *once = &on_device;                                                      \
             once != nullptr; once = nullptr)

}  // namespace manylight::test
