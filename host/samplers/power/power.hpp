// SPDX-License-Identifier: MIT
#pragma once

#include "samplers/one_light/one_light.hpp"
#include "stages/pdf.hpp"

namespace manylight {

/// A sampler that draws from one CDF by the lights' power, for the whole image: power_cdf[light].
class ByPower : public OneLight {
  public:
    ByPower(const SamplerContext& context, std::string_view file);
    void prepare() override;

    [[nodiscard]] static Footprint footprint(const SamplerLoad& load);

  private:
    PdfStage pdf_stage_;
    Mixture mixture_;
};

}  // namespace manylight
