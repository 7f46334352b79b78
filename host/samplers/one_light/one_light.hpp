// SPDX-License-Identifier: MIT
#pragma once

#include "samplers/sampler.hpp"

namespace manylight {

/// A sampler that draws lights one at a time, each by itself: kernel samples_draw of its file, from
/// tables that a deriving class makes.
class OneLight : public LightSampler {
  public:
    /// `file`: below kernels/.
    OneLight(const SamplerContext& context, std::string_view file);

    bool draw(const Tiles& tiles, const PixelSample& sample, uint light_samples,
              const Buffer<Surface>& surfaces, Estimates& estimates, const Sink& sink) override;

    [[nodiscard]] const Arguments& tables() const override { return tables_; }

    [[nodiscard]] static Footprint footprint(const SamplerLoad& load);

  protected:
    Arguments tables_;

  private:
    SampleStage stage_;
};

}  // namespace manylight
