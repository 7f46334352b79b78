// SPDX-License-Identifier: MIT
// Stages that differ from sampler to sampler: pdf, samples.
#include <cmath>
#include <cstring>

#include "reference/pdf.hpp"
#include "reference/tiles.hpp"
#include "stages/pdf.hpp"
#include "verify/sampler_checks.hpp"
#include "verify/tolerances.hpp"
#include "verify/verify.hpp"

namespace manylight {
namespace {

constexpr std::size_t most_samples = std::size_t{1} << 23;

}  // namespace

Check Verifier::pdf(std::string_view sampler, const Shares& shares, bool clustered) {
    Check check{.stage = fmt::format("pdf ({})", sampler),
                .tolerance = "16 eps of the probability (10 operations) + 2^-31 (the CDF's unit)"};
    if (scene_.lights.empty()) return check;
    const std::size_t lights = scene_.lights.size();
    const std::size_t most_rows = std::max<std::size_t>(options_.most_entries * 4 / lights, 1);
    const auto rows =
        static_cast<uint>(clustered ? std::min(clustering_.regions().size(), most_rows) : 1);
    Matrix matrix(device_, rows, static_cast<uint>(lights));
    const std::vector<float> values =
        clustered ? std::vector<float>(matrix_.begin(),
                                       matrix_.begin() + static_cast<std::ptrdiff_t>(rows * lights))
                  : std::vector<float>(lights, 0.0f);
    std::vector<uint> words(values.size());
    std::memcpy(words.data(), values.data(), values.size() * sizeof(float));
    matrix.values.upload(words);
    std::vector<RowSum> totals(rows);
    if (clustered) totals = clustering_.totals();
    totals.resize(rows);
    matrix.totals.upload(totals);
    const Mixture mixture = mixture_of(shares, scene_.lights);
    PdfStage(device_, device_scene_).normalise(rows, mixture, matrix);
    const std::vector<uint> cdf = matrix.values.download();
    for (uint row = 0; row < rows; ++row) {
        const auto entries = std::span(values).subspan(row * lights, lights);
        const std::vector<double> expected =
            reference::probabilities(entries, totals[row], scene_.lights, mixture);
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

// Where all lights are drawn and they are many, a tile of 8 x 8 pixels of which all hit the scene,
// as near to the middle as may be; otherwise all tiles.
Tiles Verifier::tiles_to_sample(uint light_samples) const {
    if (item_count(tiles_) * light_samples <= most_samples) return tiles_;
    Tiles tiles = all_tiles(options_.width, options_.height, 8);
    const uint count = tiles.count;
    tiles.count = 1;
    for (uint i = 0; i < count; ++i) {
        tiles.first = (count / 2 + (i % 2 ? count - (i + 1) / 2 : i / 2)) % count;
        bool inside = true;
        reference::for_each_pixel(tiles, [&](uint x, uint y, std::size_t) {
            const uint tile = y / tiles_.size * tiles_.columns + x / tiles_.size;
            inside = inside && tile >= tiles_.first && tile < tiles_.first + tiles_.count &&
                     found_[reference::item_of(tiles_, x, y)].position.w >= 0;
        });
        if (inside) break;
    }
    return tiles;
}

Check Verifier::samples(const Sampler& sampler) {
    Check check{.stage = fmt::format("samples ({})", sampler.name), .tolerance = shading_tolerance};
    if (scene_.lights.empty()) return check;
    const auto lights = static_cast<uint>(scene_.lights.size());
    const uint count = sampler.all_lights ? lights : 20;  // several launches
    const Tiles tiles = tiles_to_sample(count);
    const DeviceScene& uploaded = device_scene(sampler);
    const std::unique_ptr<LightSampler> drawing =
        sampler.make({device_, uploaded, scene_.lights, std::max(tiles.count, tiles_.count),
                      std::max(tiles.size, tiles_.size), options_.width, count, options_.clusters,
                      values_of(sampler)});
    drawing->prepare();
    send_out(found_);
    if (!sampler.all_lights) drawing->begin(tiles_, surfaces_, options_.seed, [](std::size_t) {});
    const std::unique_ptr<reference::Sampler> judge_sampler =
        checks_of(sampler).reference(*drawing, {scene_, tree_});
    const PixelSample sample{2, options_.seed, false};
    Buffer<Surface> surfaces = trace(tiles, {});
    const std::vector<Surface> points = surfaces.download();
    send_out(points);
    Estimates estimates{device_.allocate<float4>(item_count(tiles)),
                        device_.allocate<float4>(item_count(tiles))};
    drawing->draw(tiles, sample, count, surfaces, estimates,
                  [](const auto&, std::size_t) { return true; });
    const std::vector<float4> found = estimates.sums.download();
    const uint entries = sampler.own_rays ? std::max(count, lights) : count;  // of a pixel, at most
    const std::size_t pixels = std::max<std::size_t>(options_.most_entries / entries, 4);
    const std::size_t stride = pixel_count(tiles) / pixels | 1;
    struct Pixel {
        uint x, y;
        std::size_t item;
    };
    const auto judge_pixel = [&](uint x, uint y, std::size_t item, bool closely) {
        return judge_sampler->estimate(
            tracer_, {scene_, view_.of(item), points[item]},
            {item, y * tiles.width + x, sample.index, sample.seed, count, closely});
    };
    std::vector<Pixel> agreeing;
    std::size_t next = 0;
    reference::for_each_pixel(tiles, [&](uint x, uint y, std::size_t item) {
        if (next++ % stride != 0) return;
        const auto judge = [&](bool closely) { return judge_pixel(x, y, item, closely); };
        reference::Estimate expected = judge(false);
        const auto difference = [&] {
            return glm::length(glm::dvec3(found[item]) - expected.value);
        };
        double tolerance = (shading_roundings + 2) * epsilon * glm::length(expected.magnitude);
        if (difference() > tolerance / 4) {
            expected = judge(true);
            tolerance += expected.slack;
            if (difference() > tolerance &&
                (expected.uncertain || difference() <= tolerance + expected.borderline)) {
                check.excuse(expected.undecided);
                return check.skip_borderline();
            }
        }
        if (difference() <= tolerance) agreeing.push_back({x, y, item});
        check.compare(difference(), tolerance,
                      fmt::format("pixel ({}, {}): {} is not {}", x, y, show(found[item]),
                                  show(expected.value)),
                      found[item].r == 0 && expected.value.r == 0);
    });
    check.excuse_agreeing(agreeing.size(), [&](std::size_t i) {
        const auto [x, y, item] = agreeing[i];
        return judge_pixel(x, y, item, true).undecided;
    });
    return check;
}

}  // namespace manylight
