// SPDX-License-Identifier: MIT
// Stage seen_lights of sampler adaptive.
#include "reference/seen_lights.hpp"
#include "samplers/adaptive/seen_lights.hpp"
#include "verify/samplers/adaptive/run.hpp"
#include "verify/tolerances.hpp"

namespace manylight::adaptive_stages {

Check check_seen_lights(Verifier& verifier) {
    constexpr uint most_rays = 16;
    Check check{.stage = "seen_lights", .tolerance = exact};
    SeenLightsStage stage(verifier.device(), verifier.tree_scene(), most_rays);
    const Buffer<Surface> points = stage.look(verifier.options().seed);
    const std::vector<Surface> surfaces = points.download();
    verifier.send_out(surfaces);
    verifier.keep_materials();
    const std::vector<bool> found = stage.find(points, verifier.options().seed);
    const std::size_t stride = (most_rays * found.size() / verifier.options().most_entries) | 1;
    for (std::size_t i = 0; i < found.size(); i += stride) {
        const reference::SeenLight expected = reference::find_seen_light(
            verifier.tracer(), verifier.scene(), verifier.viewers(), surfaces,
            verifier.tree().lights[i], static_cast<uint>(i), most_rays, verifier.options().seed);
        check.excuse(expected.uncertain ? 1 : 0);
        if (found[i] != expected.seen && expected.uncertain)
            check.skip_borderline();
        else
            check.compare_exact(found[i] == expected.seen, fmt::format("light {}", i));
    }
    return check;
}

}  // namespace manylight::adaptive_stages
