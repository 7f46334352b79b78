// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <cmath>

#include "commands/commands.hpp"
#include "verify/verify.hpp"

namespace manylight {
namespace {

void print(const Check& c) {
    fmt::print("{:<32} {:>8} {:>10} {:>10.3g}  {:<6} {}\n", c.stage, c.items, c.borderline,
               c.largest,
               !c.passed()  ? "FAIL"
               : c.tested() ? "pass"
                            : "-",
               c.tolerance);
    if (c.failed > 0)
        fmt::print("    {} of {} items differ; the first: {}\n", c.failed, c.items,
                   c.first_failure);
    else if (c.passed() && !c.tested())
        fmt::print("    this scene does not test it\n");
    else if (!c.passed())
        fmt::print("    {} of {} items are borderline: too many\n", c.borderline, c.items);
}

}  // namespace

int run_verify(const VerifyArguments& arguments) {
    SceneArguments scene = arguments.scene;
    if (scene.width == 0 && scene.height == 0) scene.width = 96;
    const LoadedScene loaded = load(scene);
    const Device device = Device::open(scene.device, scene.threads, scene.lanes);
    VerifyOptions options;
    options.width = loaded.width;
    options.height = loaded.height;
    options.seed = arguments.seed;
    options.clusters = arguments.clusters;
    fmt::print("{}: {} triangles, {} lights, {} x {} pixels, on {} ({})\n\n", scene.file,
               loaded.scene.seen_triangle_count(), loaded.scene.lights.size(), loaded.width,
               loaded.height, device.info().name, device.info().platform);
    fmt::print("{:<32} {:>8} {:>10} {:>10}  {:<6} {}\n", "stage", "items", "borderline", "largest",
               "", "tolerance");
    Verifier verifier(device, loaded.scene, loaded.camera, options);
    bool passed = true;
    for (const Check& check : verifier.all()) {
        print(check);
        passed = passed && check.passed();
    }
    fmt::print(
        "\nlargest: the largest difference from the scalar reference, over its tolerance (eps: "
        "2^-23).\nborderline: items that rounding of their rays' ends decides either way.\n{}\n",
        passed ? "The device computes correctly." : "The device does NOT compute correctly.");
    return passed ? 0 : 3;
}

}  // namespace manylight
