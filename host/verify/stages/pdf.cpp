// SPDX-License-Identifier: MIT
// Stage pdf, of those samplers that have it.
#include "stages/pdf.hpp"

#include <cstring>
#include <limits>

#include "reference/pdf.hpp"
#include "verify/sampler_checks.hpp"
#include "verify/tolerances.hpp"

namespace manylight {

Check check_pdf(Verifier& verifier, std::string_view sampler, const Shares& shares,
                bool clustered) {
    Check check{.stage = fmt::format("pdf ({})", sampler),
                .tolerance = "16 eps of the probability (10 operations) + 2^-31 (the CDF's unit)"};
    if (verifier.scene().lights.empty()) return check;
    const std::size_t lights = verifier.scene().lights.size();
    const std::size_t most_rows =
        std::max<std::size_t>(verifier.options().most_entries * 4 / lights, 1);
    const auto rows = static_cast<uint>(
        clustered ? std::min(verifier.clustering().regions().size(), most_rows) : 1);
    Matrix matrix(verifier.device(), rows, static_cast<uint>(lights));
    const std::vector<float> values =
        clustered ? std::vector<float>(
                        verifier.matrix().begin(),
                        verifier.matrix().begin() + static_cast<std::ptrdiff_t>(rows * lights))
                  : std::vector<float>(lights, 0.0f);
    std::vector<uint> words(values.size());
    std::memcpy(words.data(), values.data(), values.size() * sizeof(float));
    matrix.values.upload(words);
    std::vector<RowSum> totals(rows);
    if (clustered) totals = verifier.clustering().totals();
    totals.resize(rows);
    matrix.totals.upload(totals);
    const Mixture mixture = mixture_of(shares, verifier.scene().lights);
    PdfStage(verifier.device(), verifier.device_scene()).normalise(rows, mixture, matrix);
    const std::vector<uint> cdf = matrix.values.download();
    for (uint row = 0; row < rows; ++row) {
        const auto entries = std::span(values).subspan(row * lights, lights);
        const std::vector<double> expected =
            reference::probabilities(entries, totals[row], verifier.scene().lights, mixture);
        uint before = 0;
        for (std::size_t y = 0; y < lights; ++y) {
            const uint width = cdf[row * lights + y] - before;
            before = cdf[row * lights + y];
            const double found = width / double{CDF_SCALE};
            check.compare(std::abs(found - expected[y]),
                          16 * epsilon * expected[y] + 1 / double{CDF_SCALE},
                          fmt::format("row {}, light {}: {} is not {}", row, y, found, expected[y]),
                          found == 0 && expected[y] == 0);
            // What unbiasedness rests on: a chance for whatever has a positive probability (that
            // single precision can tell from 0).
            if (expected[y] == 0 || expected[y] > std::numeric_limits<float>::min())
                check.compare(((width > 0) == (expected[y] > 0)) ? 0 : 2, 1,
                              fmt::format("row {}, light {}: zero or not", row, y),
                              width == 0 && expected[y] == 0);
        }
    }
    return check;
}

}  // namespace manylight
