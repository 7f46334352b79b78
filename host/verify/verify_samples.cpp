// SPDX-License-Identifier: MIT
// Stages that differ from sampler to sampler: pdf, samples.
#include <cmath>
#include <cstring>

#include "reference/pdf.hpp"
#include "reference/tiles.hpp"
#include "stages/samples.hpp"
#include "verify/tolerances.hpp"
#include "verify/verify.hpp"

namespace manylight {

Check Verifier::pdf(const Sampler& sampler) {
    Check check{.stage = fmt::format("pdf ({})", sampler.name),
                .tolerance = "16 eps of the probability (10 operations) + 2^-31 (the CDF's unit)"};
    if (scene_.lights.empty()) return check;
    const std::size_t lights = scene_.lights.size();
    const bool clusters = sampler.table == Table::clusters;
    const std::size_t most_rows = std::max<std::size_t>(options_.most_entries * 4 / lights, 1);
    const auto rows =
        static_cast<uint>(clusters ? std::min(clustering_.regions().size(), most_rows) : 1);
    Matrix matrix(device_, rows, static_cast<uint>(lights));
    const std::vector<float> values =
        clusters ? std::vector<float>(matrix_.begin(),
                                      matrix_.begin() + static_cast<std::ptrdiff_t>(rows * lights))
                 : std::vector<float>(lights, 0.0f);
    std::vector<uint> words(values.size());
    std::memcpy(words.data(), values.data(), values.size() * sizeof(float));
    matrix.values.upload(words);
    std::vector<RowSum> totals(rows);
    if (clusters) totals = clustering_.totals();
    totals.resize(rows);
    matrix.totals.upload(totals);
    PdfStage(device_, device_scene_).normalise(rows, mixture(sampler), matrix);
    const std::vector<uint> cdf = matrix.values.download();
    for (uint row = 0; row < rows; ++row) {
        const auto entries = std::span(values).subspan(row * lights, lights);
        const std::vector<double> expected =
            reference::probabilities(entries, totals[row], scene_.lights, mixture(sampler));
        uint before = 0;
        for (std::size_t y = 0; y < lights; ++y) {
            const uint width = cdf[row * lights + y] - before;
            before = cdf[row * lights + y];
            const double found = width / double{CDF_SCALE};
            check.compare(
                std::abs(found - expected[y]), 16 * epsilon * expected[y] + 1 / double{CDF_SCALE},
                fmt::format("row {}, light {}: {} is not {}", row, y, found, expected[y]));
            // What unbiasedness rests on: a chance for whatever has a positive probability.
            check.compare_exact((width > 0) == (expected[y] > 0),
                                fmt::format("row {}, light {}: zero or not", row, y));
        }
    }
    return check;
}

Check Verifier::samples(const Sampler& sampler) {
    Check check{.stage = fmt::format("samples ({})", sampler.name), .tolerance = shading_tolerance};
    if (scene_.lights.empty()) return check;
    const auto lights = static_cast<uint>(scene_.lights.size());
    const uint count = sampler.all_lights ? std::min(lights, 256u) : 5;
    Clustering clustering(device_, device_scene_, options_.clusters, tiles_.count);
    Matrix power(device_, 1, lights);
    Arguments tables;
    if (sampler.table == Table::clusters) {
        clustering.build(tiles_, surfaces_, [](std::size_t) {});
        clustering.normalise(mixture(sampler));
        tables = clustering.tables();
    } else if (sampler.table == Table::power) {
        power.values.clear();
        power.totals.clear();
        PdfStage(device_, device_scene_).normalise(1, mixture(sampler), power);
        tables.set("power_cdf", power.values);
    }
    const std::vector<uint> cdf = clustering.matrix().values.download();
    const std::vector<uint> power_cdf = power.values.download();
    const std::vector<uint> item_rows = clustering.item_rows();
    const reference::Tables reference_tables{power_cdf, cdf, item_rows};
    const PixelSample sample{2, options_.seed, false};
    Buffer<float4> estimates = device_.allocate<float4>(item_count(tiles_));
    SampleStage(device_, device_scene_, sampler.kernel_file)
        .draw(tiles_, sample, count, surfaces_, tables, estimates, [](std::size_t) {});
    const std::vector<float4> found = estimates.download();
    const std::size_t stride = item_count(tiles_) * count / options_.most_entries | 1;
    std::size_t next = 0;
    reference::for_each_pixel(tiles_, [&](uint x, uint y, std::size_t item) {
        if (next++ % stride != 0) return;
        const auto judge = [&](bool closely) {
            return reference::estimate(scene_, tracer_, camera_, found_[item], reference_tables,
                                       sampler.choose_light, item, y * tiles_.width + x,
                                       sample.index, sample.seed, count, closely);
        };
        reference::Estimate expected = judge(false);
        const auto difference = [&] {
            return glm::length(glm::dvec3(found[item]) - expected.value);
        };
        const double roundings = (shading_roundings + count) * epsilon;
        double tolerance = roundings * glm::length(expected.magnitude);
        if (difference() > tolerance / 4) {
            expected = judge(true);
            tolerance += expected.slack;
            if (difference() > tolerance && difference() <= tolerance + expected.borderline) {
                ++check.borderline;
                ++check.items;
                return;
            }
        }
        check.compare(difference(), tolerance,
                      fmt::format("pixel ({}, {}): {} is not {}", x, y, show(found[item]),
                                  show(expected.value)));
    });
    return check;
}

}  // namespace manylight
