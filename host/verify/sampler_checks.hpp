// SPDX-License-Identifier: MIT
// What judges a sampler: one row for each of the table.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "samplers/one_light/one_light.hpp"
#include "samplers/table.hpp"
#include "verify/verify.hpp"

namespace manylight {

/// What a reference may need beside what the sampler itself has.
struct CheckContext {
    const Scene& scene;
    const LightTree& tree;
};

struct SamplerChecks {
    /// Of a sampler whose pixels do not depend on each other's draws: the scalar reference, which
    /// draws from what the sampler, after prepare() and begin(), has made. Keeps references to the
    /// context's.
    std::unique_ptr<reference::Sampler> (*reference)(const LightSampler& sampler,
                                                     const CheckContext& context) = nullptr;
    /// The stages that its checks are of, in order.
    std::vector<std::string_view> stages = {"samples"};
    /// All of its checks, stage by stage.
    std::vector<Check> (*run)(Verifier& verifier, const Sampler& sampler) = nullptr;
};

/// The row of a sampler of the table.
[[nodiscard]] const SamplerChecks& checks_of(const Sampler& sampler);

/// The buffers that a sampler draws from, of one that draws lights one at a time.
[[nodiscard]] const Arguments& tables_of(const LightSampler& sampler);

/// Stage samples of a sampler that has a reference.
[[nodiscard]] Check check_estimates(Verifier& verifier, const Sampler& sampler);

/// For `run`: stage samples alone.
[[nodiscard]] std::vector<Check> check_samples(Verifier& verifier, const Sampler& sampler);

/// Stage pdf: CDFs of rows that are mixed by `shares`, of the contribution matrix where
/// `clustered`, else one row by power.
[[nodiscard]] Check check_pdf(Verifier& verifier, std::string_view sampler, const Shares& shares,
                              bool clustered);

/// The stages of sampler adaptive with cuts of `cut_size` nodes at most: cuts, visibility, weights,
/// samples.
[[nodiscard]] std::vector<Check> check_adaptive(Verifier& verifier, uint cut_size);

}  // namespace manylight
