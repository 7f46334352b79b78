// SPDX-License-Identifier: MIT
// Stage seen_lights of sampler adaptive.
#include "reference/seen_lights.hpp"
#include "samplers/adaptive/seen_lights.hpp"
#include "verify/tolerances.hpp"
#include "verify/verify.hpp"

namespace manylight {

Check Verifier::seen_lights() {
    constexpr uint most_rays = 16;
    Check check{.stage = "seen_lights", .tolerance = exact};
    SeenLightsStage stage(device_, tree_scene_, most_rays);
    const Buffer<Surface> points = stage.look(options_.seed);
    const std::vector<Surface> surfaces = points.download();
    send_out(surfaces);
    keep_materials();
    const std::vector<bool> found = stage.find(points, options_.seed);
    const std::size_t stride = (most_rays * found.size() / options_.most_entries) | 1;
    for (std::size_t i = 0; i < found.size(); i += stride) {
        const reference::SeenLight expected =
            reference::find_seen_light(tracer_, scene_, view_, surfaces, tree_.lights[i],
                                       static_cast<uint>(i), most_rays, options_.seed);
        check.excuse(expected.uncertain ? 1 : 0);
        if (found[i] != expected.seen && expected.uncertain)
            check.skip_borderline();
        else
            check.compare_exact(found[i] == expected.seen, fmt::format("light {}", i));
    }
    return check;
}

}  // namespace manylight
