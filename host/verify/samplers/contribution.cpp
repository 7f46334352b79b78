// SPDX-License-Identifier: MIT
#include "reference/samplers/contribution.hpp"
#include "samplers/contribution/contribution.hpp"
#include "verify/sampler_checks.hpp"

namespace manylight {

namespace {

std::unique_ptr<reference::Sampler> make_reference(const LightSampler& sampler,
                                                   const CheckContext& /*context*/) {
    const Arguments& tables = tables_of(sampler);
    return std::make_unique<reference::ByContribution>(tables.download<uint>("cdf"),
                                                       tables.download<uint>("item_rows"));
}

}  // namespace

SamplerChecks checks_contribution() {
    return {.reference = make_reference,
            .stages = {"pdf", "samples"},
            .run = [](Verifier& verifier, const Sampler& sampler) -> std::vector<Check> {
                return {check_pdf(verifier, sampler.name, paper_shares, true),
                        check_estimates(verifier, sampler)};
            }};
}

SamplerChecks checks_contribution_defensive() {
    return {.reference = make_reference,
            .stages = {"pdf", "samples"},
            .run = [](Verifier& verifier, const Sampler& sampler) -> std::vector<Check> {
                return {check_pdf(verifier, sampler.name, defensive_shares, true),
                        check_estimates(verifier, sampler)};
            }};
}

}  // namespace manylight
