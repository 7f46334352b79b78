// SPDX-License-Identifier: MIT
#include "reference/lights/lights.hpp"

#include "reference/lights/kind.hpp"

namespace manylight::reference {
namespace {

const Kind& row(const Light& light) {
#define LIGHT_ROW(name, NAME, value, traits, centroid) kind_##name(),
    static const Kind rows[] = {LIGHT_KINDS(LIGHT_ROW)};
#undef LIGHT_ROW
    static_assert(std::size(rows) == light_kind_count);
    return rows[static_cast<LightKind>(light.position.w)];
}

}  // namespace

Emission emission(const Light& light, const glm::dvec3& position, const glm::dvec2& u,
                  const LightShift& shift) {
    return row(light).emission(light, position, u, shift);
}

std::vector<LightShift> light_shifts(const Light& light, const glm::dvec3& position) {
    if (row(light).shifts == nullptr) return {};
    return row(light).shifts(light, position);
}

std::optional<double> leaf_emission(const LightNode& node, const Light& light,
                                    const glm::dvec3& to_centre, double softened) {
    if (node.count > 1 || row(light).leaf == nullptr) return {};
    return row(light).leaf(light, to_centre, softened);
}

}  // namespace manylight::reference
