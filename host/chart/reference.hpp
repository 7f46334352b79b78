// SPDX-License-Identifier: MIT
// The image that a chart judges by, and its own error.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "chart/renderer.hpp"
#include "statistics.hpp"

namespace manylight {

/// The mean of independent, unbiased images of one setting, with its variance.
class Reference {
  public:
    /// `exact`: one image is without error.
    Reference(unsigned width, unsigned height, bool exact);

    /// `seconds`: that the image took.
    void add(const Image& image, double seconds);

    [[nodiscard]] std::size_t count() const { return luminances_.size(); }
    [[nodiscard]] Image image() const;

    /// The expected relMSE of the image, and each pixel's part of it (see ErrorEstimate); of at
    /// least two images, unless it is exact.
    [[nodiscard]] ErrorEstimate error() const;

    /// That all images took.
    [[nodiscard]] double seconds() const { return seconds_; }

    /// The mean luminance, cd/m2, with its standard error.
    [[nodiscard]] Mean luminance() const;

    /// Writes all of it to an .exr (see write_file); `key` says what it is of.
    void save(const std::string& path, const std::string& key) const;

    /// What save() wrote. Throws InputError where the file holds something else.
    [[nodiscard]] static Reference load(const std::string& path, const std::string& key,
                                        unsigned width, unsigned height, bool exact);

  private:
    unsigned width_, height_;
    bool exact_;
    std::vector<double> means_;       // [3 * pixel + channel]
    std::vector<double> deviations_;  // likewise: sums of squared deviations from the mean
    double seconds_ = 0;
    std::vector<double> luminances_;  // [image] mean luminance, cd/m2
};

/// How each image of a reference is made: of all lights where they are few enough, otherwise by
/// sampler adaptive; with so many samples that it takes some seconds.
[[nodiscard]] Setting reference_setting(const Renderer& renderer);

/// The file of a reference in a cache: named after all that its image depends on.
[[nodiscard]] std::string reference_name(const Renderer& renderer, const Setting& setting);

/// The folder for references: `asked`, or else manylight/references in the user's cache folder
/// (XDG_CACHE_HOME). Makes it. Throws InputError.
[[nodiscard]] std::string reference_folder(const std::string& asked);

}  // namespace manylight
