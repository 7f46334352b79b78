// SPDX-License-Identifier: MIT
#include "stages/contributions.hpp"

namespace manylight {
namespace {

constexpr std::size_t entries_per_launch = std::size_t{1} << 22;  // about a second of shadow rays

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
      evaluate_(device.kernel("contributions.cl", "contributions_evaluate", scene.shading,
                              "contributions")),
      sum_(device.kernel("contributions.cl", "contributions_sum", scene.shading, "contributions")),
      total_(device.kernel("contributions.cl", "contributions_total", scene.shading,
                           "contributions")) {}

void ContributionStage::evaluate(const Buffer<Surface>& surfaces,
                                 const Buffer<uint>& representatives, uint first, uint count,
                                 Matrix& matrix, const std::function<void(std::size_t)>& progress) {
    const uint chunks = chunk_count(matrix.light_count);
    Arguments arguments = scene_;
    arguments.set("surfaces", surfaces)
        .set("representatives", representatives)
        .set("contributions", matrix.values)
        .set("sums", matrix.chunk_sums)
        .set("chunks", chunks)
        .set("totals", matrix.totals);
    const auto step = static_cast<uint>(
        std::max<std::size_t>(entries_per_launch / std::max(matrix.light_count, 1u), 1));
    for (uint row = first; row < first + count; row += step) {
        const uint rows = std::min(step, first + count - row);
        const std::size_t entries = std::size_t{rows} * matrix.light_count;
        arguments.set("first_row", row).set("row_count", rows);
        evaluate_.launch(entries, arguments);
        sum_.launch(std::size_t{rows} * chunks, arguments);
        total_.launch(rows, arguments);
        progress(entries);
    }
}

}  // namespace manylight
