// SPDX-License-Identifier: MIT
#include "stages/contributions.hpp"

namespace manylight {
namespace {

std::size_t packets_of_row(uint lights) { return (std::size_t{lights} + 15) / 16; }

// As many rows as come to about a million rays, whose packets the caches hold; at least one.
std::size_t rows_per_launch(uint lights) {
    return std::max<std::size_t>(65536 / std::max<std::size_t>(packets_of_row(lights), 1), 1);
}

}  // namespace

Matrix::Matrix(Device& device, uint rows, uint lights)
    : light_count(lights),
      values(device.allocate<uint>(std::size_t{rows} * lights)),
      chunk_sums(device.allocate<RowSum>(std::size_t{rows} * chunk_count(lights))),
      totals(device.allocate<RowSum>(rows)),
      chunk_widths(device.allocate<uint>(std::size_t{rows} * chunk_count(lights))) {}

std::size_t Matrix::row_bytes(uint lights) {
    return std::size_t{lights} * sizeof(uint) + sizeof(RowSum) +
           chunk_count(lights) * (sizeof(RowSum) + sizeof(uint));
}

ContributionStage::ContributionStage(Device& device, const DeviceScene& scene)
    : scene_(scene.arguments),
      shadows_(device, scene,
               rows_per_launch(scene.light_count) * packets_of_row(scene.light_count)),
      aim_(device.kernel("contributions.cl", "contributions_aim", scene.shading, "contributions")),
      hide_(
          device.kernel("contributions.cl", "contributions_hide", scene.shading, "contributions")),
      sum_(device.kernel("contributions.cl", "contributions_sum", scene.shading, "contributions")),
      total_(device.kernel("contributions.cl", "contributions_total", scene.shading,
                           "contributions")) {}

void ContributionStage::evaluate(const Buffer<Surface>& surfaces,
                                 const Buffer<uint>& representatives, uint first, uint count,
                                 Matrix& matrix, const std::function<void(std::size_t)>& progress) {
    const uint chunks = chunk_count(matrix.light_count);
    Arguments arguments = scene_;
    arguments.set(shadows_.buffers())
        .set("surfaces", surfaces)
        .set("representatives", representatives)
        .set("contributions", matrix.values.as<float>())
        .set("sums", matrix.chunk_sums)
        .set("chunks", chunks)
        .set("totals", matrix.totals);
    const auto step = static_cast<uint>(rows_per_launch(matrix.light_count));
    for (uint row = first; row < first + count; row += step) {
        const uint rows = std::min(step, first + count - row);
        const std::size_t packets = rows * packets_of_row(matrix.light_count);
        arguments.set("first_row", row).set("row_count", rows);
        aim_.launch(16 * packets, arguments);
        shadows_.trace(packets);
        hide_.launch(16 * packets, arguments);
        sum_.launch(std::size_t{rows} * chunks, arguments);
        total_.launch(rows, arguments);
        progress(std::size_t{rows} * matrix.light_count);
    }
}

std::size_t ContributionStage::ray_bytes(uint light_count) {
    return rows_per_launch(light_count) * packets_of_row(light_count) * ShadowStage::packet_bytes();
}

}  // namespace manylight
