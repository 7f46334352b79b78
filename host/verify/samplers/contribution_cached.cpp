// SPDX-License-Identifier: MIT
#include "reference/samplers/contribution_cached.hpp"
#include "samplers/contribution_cached/contribution_cached.hpp"
#include "shared/contribution_cached.h"
#include "verify/sampler_checks.hpp"
#include "verify/tolerances.hpp"

namespace manylight {
namespace {

std::unique_ptr<reference::Sampler> make_reference(const LightSampler& sampler,
                                                   const CheckContext& /*context*/) {
    const Arguments& tables = tables_of(sampler);
    return std::make_unique<reference::ContributionCached>(
        reference::ContributionCached::Tables{
            tables.download<uint>("cdf"), tables.download<uint>("item_rows"),
            tables.download<uint>("neighbours"), tables.download<float4>("places")},
        dynamic_cast<const ContributionCached&>(sampler).most_rows());
}

// A cluster's neighbours are the nearest of those that the reference finds: each is among them, and
// as near as the one in its place.
void check_cluster(Check& check, std::span<const uint> found,
                   std::span<const reference::Neighbour> expected, uint row) {
    const auto doubtful = static_cast<std::size_t>(
        std::ranges::count(expected, true, &reference::Neighbour::doubtful));
    for (std::size_t i = 0; i < found.size(); ++i) {
        const std::string where = fmt::format("cluster {}, neighbour {}", row, i);
        const std::size_t sure = expected.size() - doubtful;
        if (found[i] == NO_ROW) {
            check.compare_exact(i >= sure, where + ": there is one");
            continue;
        }
        const auto same = std::ranges::find(expected, found[i], &reference::Neighbour::row);
        if (same == expected.end()) {
            check.compare_exact(false, where + ": it is none");
            continue;
        }
        const bool repeated = std::ranges::count(found, found[i]) > 1;
        check.compare_exact(!repeated, where + ": it is there twice");
        if (doubtful > 0) {
            check.excuse(1);
            check.skip_borderline();
            continue;
        }
        check.compare(
            std::abs(same->distance - expected[i].distance),
            8 * epsilon * (expected[i].distance + 1e-3),
            fmt::format("{}: at {} m, not {} m", where, same->distance, expected[i].distance));
    }
}

Check check_neighbours(Verifier& verifier, const Sampler& sampler) {
    Check check{.stage = "neighbours", .tolerance = "8 eps of the distance (some 6 operations)"};
    if (verifier.lights().empty()) return check;
    const Tiles& tiles = verifier.tiles();
    ContributionCached drawing({verifier.device(), verifier.device_scene(sampler),
                                verifier.lights(), tiles.count, tiles.size, tiles.width, 1,
                                verifier.options().clusters, values_of(sampler)});
    drawing.begin(tiles, verifier.surfaces(), verifier.options().seed, [](std::size_t) {});
    const Clustering& clustering = drawing.clustering();
    const std::vector<uint> representatives = clustering.representatives();
    const std::vector<Surface>& surfaces = verifier.found_surfaces();
    const auto neighbours = drawing.tables().download<uint>("neighbours");
    const auto places = drawing.tables().download<float4>("places");
    for (uint row = 0; row < representatives.size(); ++row) {
        if (clustering.split()[row]) continue;
        if (representatives[row] != NO_ITEM)
            check.compare_exact(
                glm::vec3(places[row]) == glm::vec3(surfaces[representatives[row]].position),
                fmt::format("cluster {}: its place", row));
        check_cluster(check, std::span(neighbours).subspan(MOST_NEIGHBOURS * row, MOST_NEIGHBOURS),
                      reference::neighbours(tiles, clustering.regions(), clustering.split(),
                                            representatives, surfaces, row, drawing.least_cosine()),
                      row);
    }
    return check;
}

}  // namespace

SamplerChecks checks_contribution_cached() {
    return {.reference = make_reference,
            .stages = {"pdf", "neighbours", "samples"},
            .run = [](Verifier& verifier, const Sampler& sampler) -> std::vector<Check> {
                return {check_pdf(verifier, sampler.name, defensive_shares, true),
                        check_neighbours(verifier, sampler), check_estimates(verifier, sampler)};
            }};
}

}  // namespace manylight
