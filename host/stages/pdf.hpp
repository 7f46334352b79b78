// SPDX-License-Identifier: MIT
#pragma once

#include "stages/contributions.hpp"

namespace manylight {

/// How a row of weights is mixed; see Mixture in shared/contribution.h.
struct Shares {
    float visible = 0;
    float unshadowed = 0;
    float power = 0;
};

/// The same for a scene's lights.
[[nodiscard]] Mixture mixture_of(const Shares& shares, const std::vector<Light>& lights);

/// Stage pdf: rows of the contribution matrix to CDFs (paper 4.2, eq. (6)); see
/// shared/contribution.h.
class PdfStage {
  public:
    PdfStage(Device& device, const DeviceScene& scene);

    /// Turns rows 0 to count of the matrix to CDFs, in place: row entry `light` becomes the sum of
    /// the integer widths of lights 0 to `light`.
    void normalise(uint count, const Mixture& mixture, Matrix& matrix);

    /// One row from the lights' powers alone: power_cdf[light].
    [[nodiscard]] Buffer<uint> of_powers(const Mixture& mixture);

  private:
    Device device_;
    uint light_count_;
    Arguments scene_;
    Kernel quantise_;
    Kernel scan_;
    Kernel add_;
};

}  // namespace manylight
