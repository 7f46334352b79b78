// SPDX-License-Identifier: MIT
#include "reference/samplers/contribution_cached.hpp"

#include <algorithm>
#include <cmath>

#include "shared/contribution_cached.h"

namespace manylight::reference {
namespace {

constexpr double doubtful = doubtful_draw;  // also of distances, relative

}  // namespace

std::vector<Neighbour> neighbours(const Tiles& tiles, std::span<const Region> regions,
                                  std::span<const uint> split,
                                  std::span<const uint> representatives,
                                  std::span<const Surface> surfaces, uint row,
                                  double least_cosine) {
    std::vector<Neighbour> found;
    if (representatives[row] == NO_ITEM) return found;
    const auto tile_of = [&](uint r) {
        return std::array{int(regions[r].x / tiles.size), int(regions[r].y / tiles.size)};
    };
    const Surface& own = surfaces[representatives[row]];
    const auto [column, line] = tile_of(row);
    for (uint other = 0; other < regions.size(); ++other) {
        const auto [x, y] = tile_of(other);
        if (other == row || split[other] || representatives[other] == NO_ITEM) continue;
        if (std::abs(x - column) > 1 || std::abs(y - line) > 1) continue;
        const Surface& surface = surfaces[representatives[other]];
        const double cosine =
            glm::dot(glm::dvec3(glm::vec3(own.normal)), glm::dvec3(glm::vec3(surface.normal)));
        if (cosine < least_cosine - doubtful) continue;
        const double distance = glm::distance(glm::dvec3(glm::vec3(own.position)),
                                              glm::dvec3(glm::vec3(surface.position)));
        found.push_back({other, distance, cosine < least_cosine + doubtful});
    }
    std::ranges::sort(found, {}, &Neighbour::distance);
    return found;
}

double ContributionCached::Rows::probability(uint light) const {
    if (cdfs.empty()) return 0;
    const double own = share_of(cdfs[0], light);
    if (cdfs.size() == 1) return own;
    double sum = 0;
    for (const std::span<const uint> cdf : std::span(cdfs).subspan(1)) sum += share_of(cdf, light);
    return own / 2 + sum / 2 / static_cast<double>(cdfs.size() - 1);
}

ContributionCached::Rows ContributionCached::rows_of(const Point& point, std::size_t item) const {
    const std::size_t lights = point.scene.lights.size();
    const auto cdf_of = [&](uint row) {
        return std::span(tables_.cdf).subspan(row * lights, lights);
    };
    const uint own = tables_.item_rows[item];
    struct Near {
        uint row;
        double distance;
    };
    std::vector<Near> near;
    for (const uint row :
         std::span(tables_.neighbours).subspan(MOST_NEIGHBOURS * own, MOST_NEIGHBOURS)) {
        if (row == NO_ROW) break;
        near.push_back({row, glm::distance(glm::dvec3(glm::vec3(tables_.places[row])),
                                           glm::dvec3(glm::vec3(point.surface.position)))});
    }
    std::ranges::stable_sort(near, {}, &Near::distance);
    Rows rows;
    if (cdf_of(own).back() > 0) rows.cdfs.push_back(cdf_of(own));
    for (std::size_t i = 0; i < near.size() && rows.cdfs.size() < most_rows_; ++i) {
        if (cdf_of(near[i].row).back() == 0) continue;
        rows.cdfs.push_back(cdf_of(near[i].row));
        if (i + 1 < near.size() &&
            near[i + 1].distance - near[i].distance <= doubtful * near[i + 1].distance)
            rows.doubtful = true;
    }
    return rows;
}

Choice ContributionCached::choose(const Point& point, const Draw& draw) const {
    const Rows rows = rows_of(point, draw.item);
    if (rows.cdfs.empty()) return {0, 0};
    // The own row has as many places as all others together.
    std::vector<std::size_t> places(std::max<std::size_t>(rows.cdfs.size() - 1, 1), 0);
    for (std::size_t i = 1; i < rows.cdfs.size(); ++i) places.push_back(i);
    const std::size_t place = (std::uint64_t{draw.bits[3]} * places.size()) >> 32;
    Choice choice = draw_from(rows.cdfs[places[place]], draw);
    choice.weight = 1 / (rows.probability(choice.light) * draw.sample_count);
    choice.borderline = rows.doubtful;
    return choice;
}

std::optional<double> ContributionCached::probability(const Point& point, std::size_t item,
                                                      uint light) const {
    return rows_of(point, item).probability(light);
}

std::optional<ExpectedCount> ContributionCached::expected_count(const Point& point,
                                                                std::size_t item, uint light,
                                                                uint sample_count) const {
    const Rows rows = rows_of(point, item);
    return ExpectedCount{{{1, rows.probability(light) * sample_count}}, rows.doubtful};
}

}  // namespace manylight::reference
