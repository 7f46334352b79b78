// SPDX-License-Identifier: MIT
// What judges a sampler: one row for each of the table.
#pragma once

#include <vector>

#include "samplers/contribution/options.hpp"
#include "samplers/table.hpp"
#include "verify/verify.hpp"

namespace manylight {

struct SamplerChecks {
    /// Of a sampler that draws lights one at a time: the scalar reference of its choice.
    reference::ChooseLight choose_light = nullptr;
    /// Likewise, where there is a closed form of the probability that a draw is of a light.
    reference::LightProbability light_probability = nullptr;
    /// All checks that the sampler has, stage by stage.
    std::vector<Check> (*run)(Verifier& verifier, const Sampler& sampler) = nullptr;
};

/// What a sampler that draws lights one at a time draws from, on the host.
struct HostTables {
    explicit HostTables(const LightSampler& sampler);
    [[nodiscard]] reference::Tables view(const LightTree& tree) const {
        return {power_cdf, cdf, item_rows, &tree};
    }

    std::vector<uint> power_cdf;
    std::vector<uint> cdf;
    std::vector<uint> item_rows;
};

/// The row of a sampler of the table.
[[nodiscard]] const SamplerChecks& checks_of(const Sampler& sampler);

/// For `run`: stage samples alone.
[[nodiscard]] std::vector<Check> check_samples(Verifier& verifier, const Sampler& sampler);

}  // namespace manylight
