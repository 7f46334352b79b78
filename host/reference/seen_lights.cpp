// SPDX-License-Identifier: MIT
#include "reference/seen_lights.hpp"

#include "reference/contributions.hpp"
#include "reference/random.hpp"

namespace manylight::reference {

SeenLight find_seen_light(const Tracer& tracer, const Scene& scene, const Viewers& view,
                          std::span<const Surface> surfaces, const Light& light, uint number,
                          uint most_rays, uint seed) {
    const auto bits = random_bits(number, 0, 0xfffffffbu, seed);
    SeenLight found;
    uint rays = 0;
    for (std::size_t i = 0; i < surfaces.size() && rays < most_rays; ++i) {
        const std::size_t item = (bits[0] + i * (bits[1] | 1)) % surfaces.size();
        const Surface& s = surfaces[item];
        if (s.position.w < 0) continue;
        const Material& material = scene.materials[s.shading];
        const Unshadowed term = unshadowed(s, material, view.of(item), light, centroid(light));
        // Whether there is light at all: a light with area is hardly seen in its own plane.
        if (glm::length(term.value) <=
            rounding_slack(s, material, view.of(item), light, centroid(light)))
            found.uncertain = found.uncertain || has_area(light);
        if (term.value == glm::dvec3(0)) continue;
        ++rays;
        if (tracer.occlusion_is_borderline(term.shadow, term.rounding)) found.uncertain = true;
        if (tracer.occluded(term.shadow)) continue;
        found.seen = true;
        break;
    }
    return found;
}

}  // namespace manylight::reference
