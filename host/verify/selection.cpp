// SPDX-License-Identifier: MIT
#include "verify/selection.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace manylight {
namespace {

bool takes(const std::vector<std::string>& list, std::string_view name) {
    return list.empty() || std::ranges::find(list, name) != list.end();
}

}  // namespace

bool Selection::takes_stage(std::string_view stage) const { return takes(stages, stage); }

bool Selection::takes_one_of(std::span<const std::string_view> of) const {
    return std::ranges::any_of(of, [&](std::string_view stage) { return takes(stages, stage); });
}

bool Selection::takes_sampler(std::string_view sampler) const { return takes(samplers, sampler); }

bool Selection::takes_scene(std::string_view scene) const { return takes(scenes, scene); }

std::string Selection::words() const {
    std::vector<std::string> words;
    const auto add = [&](const char* option, const std::vector<std::string>& list) {
        if (!list.empty()) words.push_back(fmt::format("--{} {}", option, fmt::join(list, ",")));
    };
    add("scene", scenes);
    add("stage", stages);
    add("sampler", samplers);
    return fmt::format("{}", fmt::join(words, " "));
}

}  // namespace manylight
