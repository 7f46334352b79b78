// SPDX-License-Identifier: MIT
// What a pixel's report tells: its nodes by what they give and take, and why there is noise.
#pragma once

#include <string>
#include <vector>

#include "commands/commands.hpp"
#include "explain/inspect.hpp"

namespace manylight {

/// A pixel's report with what it is about.
struct Inspected {
    const LoadedScene& loaded;
    const LightTree& tree;
    const PixelReport& report;
    std::vector<InspectedNode> ranked;  // by share of the light, the draws or the noise
    double luminance;                   // of all lights, cd/m2
    double draws;
    uint spp;
    glm::vec3 rendered;  // cd/m2
    glm::vec3 emitted;   // by the surface itself, cd/m2

    [[nodiscard]] double light_share(const InspectedNode& n) const;
    [[nodiscard]] double draw_share(const InspectedNode& n) const;
    /// Standard deviation of the luminance of a pixel sample over the luminance.
    [[nodiscard]] double deviation() const;
    [[nodiscard]] const LightNode& node(const InspectedNode& n) const { return tree.nodes[n.node]; }
    /// The light of a node that has one.
    [[nodiscard]] std::size_t light(const InspectedNode& n) const;
    [[nodiscard]] std::string name(const InspectedNode& n) const;
    [[nodiscard]] std::string place(const InspectedNode& n) const;
    /// In the file's frame, or a direction.
    [[nodiscard]] glm::dvec3 centre(const LightNode& n) const;
};

/// A report with its nodes ranked; without `spp` and `rendered`, which are the image's.
[[nodiscard]] Inspected rank(const LoadedScene& loaded, const LightTree& tree,
                             const PixelReport& report);

/// "12.3%".
[[nodiscard]] std::string percent(double share);

/// The reasons of the pixel's noise, in sentences.
[[nodiscard]] std::vector<std::string> explain(const Inspected& in);

}  // namespace manylight
