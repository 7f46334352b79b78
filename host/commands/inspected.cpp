// SPDX-License-Identifier: MIT
#include "commands/inspected.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "commands/describe.hpp"
#include "reference/shading.hpp"

namespace manylight {
namespace {

constexpr double believed_hidden = 0.25;  // V^ below

// What a pixel's surface emits to the camera.
glm::vec3 emission_of(const PixelReport& report) {
    if (!report.hit()) return glm::vec3(0);
    const float4& emission = report.material.emission;
    return report.surface.front || emission.w != 0 ? glm::vec3(emission) : glm::vec3(0);
}

// Why a node makes noise.
std::string reason(const Inspected& in, const InspectedNode& n) {
    const double light = in.light_share(n);
    const double draws = in.draw_share(n);
    if (n.facing == 0)
        return fmt::format("cannot light this pixel but gets {} of the draws", percent(draws));
    if (n.seen == 0)
        return fmt::format(
            "is hidden here, but the sampler reckons with V^ {:.2f}, which only {:.3f} draws in a "
            "sample correct",
            n.visibility, n.draws);
    const std::string both = fmt::format("gives {} of the light and gets {} of the draws",
                                         percent(light), percent(draws));
    if (light > draws && n.visibility < believed_hidden)
        return fmt::format("{}, being believed hidden (V^ {:.2f})", both, n.visibility);
    if (light > 1.5 * draws) return both + ", being estimated too low";
    if (draws > 1.5 * light) return both + ", being estimated too high";
    if (n.seen > 0 && n.seen < n.facing)
        return fmt::format("{}, and only {} of its {} lights are visible", both, n.seen, n.facing);
    return both;
}

}  // namespace

double Inspected::light_share(const InspectedNode& n) const {
    return luminance > 0 ? n.contribution / luminance : 0;
}

double Inspected::draw_share(const InspectedNode& n) const {
    return draws > 0 ? n.draws / draws : 0;
}

double Inspected::deviation() const {
    return luminance > 0 ? std::sqrt(report.variance) / luminance : 0;
}

std::size_t Inspected::light(const InspectedNode& n) const { return tree.order[node(n).first]; }

std::string Inspected::name(const InspectedNode& n) const {
    return node(n).count == 1 ? name_of(loaded.scene, light(n))
                              : fmt::format("{} lights", node(n).count);
}

std::string Inspected::place(const InspectedNode& n) const {
    if (node(n).count == 1) return place_of(loaded.scene, light(n));
    return (NODE_IS_INFINITE(node(n)) ? "from " : "round ") + show(centre(node(n)));
}

glm::dvec3 Inspected::centre(const LightNode& n) const {
    const glm::vec3 centre(n.centre);
    return NODE_IS_INFINITE(n) ? glm::dvec3(centre) : loaded.scene.in_file(centre);
}

Inspected rank(const LoadedScene& loaded, const LightTree& tree, const PixelReport& report) {
    Inspected out{loaded, tree, report, report.nodes, 0, report.draws(), 0, {}, {}};
    out.luminance = reference::luminance(report.radiance);
    out.emitted = emission_of(report);
    std::ranges::stable_sort(out.ranked, std::greater(), [&](const InspectedNode& n) {
        return std::max({out.light_share(n), out.draw_share(n), n.noise});
    });
    return out;
}

std::string percent(double share) { return fmt::format("{:.3g}%", 100 * share); }

std::vector<std::string> explain(const Inspected& in) {
    if (in.luminance == 0 && in.report.variance == 0)
        return {"It reflects no light, and has no noise."};
    if (in.luminance == 0)
        return {
            fmt::format("It reflects no light; a pixel sample deviates by {:.3g} cd/m2, where "
                        "lights that are hidden here are drawn.",
                        std::sqrt(in.report.variance))};
    std::vector<std::string> out = {
        fmt::format("A pixel sample here deviates by {} of the light, for the choice of lights; "
                    "the mean of {} by {}.",
                    percent(in.deviation()), in.spp,
                    percent(in.deviation() / std::sqrt(static_cast<double>(in.spp))))};
    const InspectedNode& worst = *std::ranges::max_element(in.ranked, {}, &InspectedNode::noise);
    if (in.report.count_noise > worst.noise)
        out.push_back(fmt::format(
            "The largest part of that variance, {}, is by the number of draws: {:.0f} or {:.0f}.",
            percent(in.report.count_noise), std::floor(in.draws), std::ceil(in.draws)));
    else if (worst.noise > 0)
        out.push_back(fmt::format("The largest part of that variance, {}, is by {} {}: it {}.",
                                  percent(worst.noise), in.name(worst), in.place(worst),
                                  reason(in, worst)));
    const double off = luminance(in.rendered) - luminance(in.emitted) - in.luminance;
    const double expected = std::sqrt(in.report.variance / in.spp);
    if (std::abs(off) > 3 * expected && std::abs(off) > 0.01 * in.luminance)
        out.push_back(
            fmt::format("The rendered pixel is off by {:+.3g}%: its earlier samples knew less than "
                        "is known now, or it differs from its centre.",
                        100 * off / in.luminance));
    double hidden_light = 0;
    double hidden_draws = 0;
    for (const InspectedNode& n : in.ranked) {
        if (n.visibility < believed_hidden) hidden_light += in.light_share(n);
        if (n.contribution == 0) hidden_draws += in.draw_share(n);
    }
    out.push_back(
        fmt::format("{} of the light is by what the sampler believes hidden (V^ below {}); {} of "
                    "the draws go to what gives no light here.",
                    percent(hidden_light), believed_hidden, percent(hidden_draws)));
    return out;
}

}  // namespace manylight
