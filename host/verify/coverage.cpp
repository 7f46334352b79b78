// SPDX-License-Identifier: MIT
#include "verify/coverage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "device/kernel_sources.hpp"
#include "samplers/table.hpp"

namespace manylight {
namespace {

bool is_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

// The name that starts at a position.
std::string name_at(std::string_view text, std::size_t at) {
    std::size_t end = at;
    while (end < text.size() && is_name(text[end])) ++end;
    return std::string(text.substr(at, end - at));
}

// The names that follow `before`, which no name does; comments do not count, nor does a mere
// `before` that macros make names of.
std::vector<std::string> names_after(std::string_view source, std::string_view before,
                                     bool with_it) {
    std::vector<std::string> names;
    while (!source.empty()) {
        const std::size_t length = std::min(source.find('\n'), source.size() - 1) + 1;
        std::string_view line = source.substr(0, length);
        source.remove_prefix(length);
        line = line.substr(0, line.find("//"));
        for (std::size_t at = line.find(before); at != std::string_view::npos;
             at = line.find(before, at + 1))
            if ((at == 0 || !is_name(line[at - 1])) && name_at(line, at) != before)
                names.push_back(name_at(line, with_it ? at : at + before.size()));
    }
    return names;
}

// Whether a check judges what a kernel makes.
bool judges(const Check& check, const Launched& kernel) {
    const std::string stage = stage_of(check);
    // Whether rays pass is judged where it is used.
    if (kernel.stage == "shadows") return stage == "contributions" || stage == "samples";
    if (kernel.stage == "probe") return kernel.kernel == "probe_" + stage;
    if (kernel.stage != stage) return false;
    const bool of_sampler = stage == "samples" || stage == "reflections";
    if (!of_sampler || !kernel.file.starts_with("samplers/")) return true;
    // "ris" of "samplers/ris/ris.cl": the folder is the sampler's, and of those that extend it.
    std::string folder = kernel.file.substr(9, kernel.file.find('/', 9) - 9);
    std::ranges::replace(folder, '_', '-');  // as names have it
    const std::string own = fmt::format("{} ({}", stage, folder);
    return check.stage.starts_with(own + ")") || check.stage.starts_with(own + "-");
}

}  // namespace

std::vector<KernelCode> all_kernels() {
    std::vector<KernelCode> kernels;
    for (const auto& [file, text] : kernel_sources) {
        if (!file.ends_with(".cl")) continue;
        const std::string source = assemble_source(file);
        const std::vector<std::string> features = names_after(source, "HAS_", true);
        for (const std::string& name : names_after(source, "KERNEL void ", false))
            kernels.push_back(
                {std::string(file), name, std::set(features.begin(), features.end())});
    }
    return kernels;
}

void Coverage::add(const std::set<Launched>& launched, const std::vector<Check>& checks) {
    for (const Check& check : checks) {
        if (std::ranges::find(stages_, check.stage) == stages_.end())
            stages_.push_back(check.stage);
        if (check.tested()) told_.insert(check.stage);
    }
    for (const Launched& kernel : launched)
        if (std::ranges::any_of(checks,
                                [&](const Check& c) { return c.tested() && judges(c, kernel); }))
            tested_[{kernel.file, kernel.kernel}].push_back(kernel.defines);
}

Coverage::State Coverage::state(const KernelCode& kernel) const {
    if (tested_.contains({kernel.file, kernel.name})) return State::tested;
    // What `bench` alone launches it judges itself, whenever it runs.
    if (kernel.file == "bench.cl") return State::not_rendering;
    // Forms differ in how rays are traced: packets, or single rays. Packets need one origin, which
    // rays of a camera without perspective have not.
    const bool other =
        packets_ ? kernel.name == "shadows_trace_rays" : kernel.name.ends_with("_trace_packets");
    return other ? State::other_form : State::not_tested;
}

std::vector<std::string> Coverage::missing(const KernelCode& kernel, bool with) const {
    std::vector<std::string> names;
    const auto tested = tested_.find({kernel.file, kernel.name});
    if (tested == tested_.end()) return names;
    for (const std::string& feature : kernel.features) {
        const auto has = [&](const Defines& defines) {
            const auto found = defines.find(feature);
            return (found != defines.end() && found->second != 0) == with;
        };
        if (std::ranges::none_of(tested->second, has)) names.push_back(feature);
    }
    return names;
}

std::vector<std::string> Coverage::silent_stages() const {
    std::vector<std::string> out;
    for (const std::string& stage : stages_)
        if (!told_.contains(stage)) out.push_back("stage " + stage);
    return out;
}

std::vector<std::string> Coverage::not_tested(bool without) const {
    std::vector<std::string> out = silent_stages();
    std::map<std::string, std::vector<std::string>> by_feature;  // kernels that lack it
    std::map<std::string, std::size_t> users;                    // kernels that know it
    for (const KernelCode& kernel : all_kernels()) {
        if (state(kernel) == State::not_tested)
            out.push_back(fmt::format("kernel {} of {}", kernel.name, kernel.file));
        if (state(kernel) != State::tested) continue;
        for (const bool with : {true, false}) {
            if (!with && !without) continue;
            const char* word = with ? "with" : "without";
            for (const std::string& feature : kernel.features)
                ++users[fmt::format("{} {}", word, feature)];
            for (const std::string& feature : missing(kernel, with))
                by_feature[fmt::format("{} {}", word, feature)].push_back(
                    fmt::format("{} of {}", kernel.name, kernel.file));
        }
    }
    std::vector<std::string> everywhere;  // what no kernel was tested with, or without
    for (const auto& [feature, kernels] : by_feature)
        if (kernels.size() == users[feature]) everywhere.push_back(feature);
        // Less code than with it; and some kernels are of no use without it.
        else if (!feature.starts_with("without"))
            out.push_back(fmt::format("{} {}", fmt::join(kernels, ", "), feature));
    if (!everywhere.empty()) out.push_back(fmt::format("kernels {}", fmt::join(everywhere, ", ")));
    return out;
}

}  // namespace manylight
