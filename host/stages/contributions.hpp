// SPDX-License-Identifier: MIT
#pragma once

#include <functional>

#include "shared/contribution.h"
#include "shared/surface.h"
#include "stages/device_scene.hpp"
#include "stages/shadows.hpp"

namespace manylight {

/// Chunks of a row of the matrix.
[[nodiscard]] constexpr uint chunk_count(uint light_count) {
    return (light_count + LIGHT_CHUNK - 1) / LIGHT_CHUNK;
}

/// A batch's cluster x light matrix and what belongs to its rows.
struct Matrix {
    uint light_count = 0;
    /// contributions[row * light_count + light]: C(a, y) with V = 1, cd/m2 (luminance), negative
    /// where the light is hidden; after stage pdf the row's CDF in the same bytes.
    Buffer<uint> values;
    Buffer<RowSum> chunk_sums;  // [row * chunk_count + chunk]
    Buffer<RowSum> totals;      // [row]
    Buffer<uint> chunk_widths;  // [row * chunk_count + chunk], used by stage pdf

    Matrix(Device& device, uint rows, uint light_count);
    /// Bytes that a row takes on the device.
    [[nodiscard]] static std::size_t row_bytes(uint light_count);
};

/// Stage contributions: every light at every representative, shadows included (paper (4), (5)).
class ContributionStage {
  public:
    ContributionStage(Device& device, const DeviceScene& scene);

    /// Bytes on the device for the rays of one launch.
    [[nodiscard]] static std::size_t ray_bytes(uint light_count);

    /// Fills rows first to first + count, of the regions' representatives, and their totals.
    /// `progress` is called with the entries done after each launch.
    void evaluate(const Buffer<Surface>& surfaces, const Buffer<uint>& representatives, uint first,
                  uint count, Matrix& matrix, const std::function<void(std::size_t)>& progress);

  private:
    Arguments scene_;
    ShadowStage shadows_;
    Kernel aim_;
    Kernel hide_;
    Kernel sum_;
    Kernel total_;
};

}  // namespace manylight
