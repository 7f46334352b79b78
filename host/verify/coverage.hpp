// SPDX-License-Identifier: MIT
// Which of the program's kernels, and which of their features, checks have told something about.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "device/device.hpp"
#include "verify/verify.hpp"

namespace manylight {

/// A kernel of the program.
struct KernelCode {
    std::string file;                // below kernels/
    std::string name;                // in it
    std::set<std::string> features;  // HAS_...: what its file is compiled with or without
    bool operator==(const KernelCode&) const = default;
};

/// Every `KERNEL void name` of every kernels/*.cl, its includes searched too.
[[nodiscard]] std::vector<KernelCode> all_kernels();

class Coverage {
  public:
    /// `packets`: whether the device's form traces rays together (see DeviceForm).
    explicit Coverage(bool packets) : packets_(packets) {}

    /// Takes in what was launched for some checks of one scene.
    void add(const std::set<Launched>& launched, const std::vector<Check>& checks);

    enum class State { tested, not_tested, other_form, not_rendering };
    [[nodiscard]] State state(const KernelCode& kernel) const;

    /// The features of a tested kernel that it was never tested with, or never without.
    [[nodiscard]] std::vector<std::string> missing(const KernelCode& kernel, bool with) const;

    /// In words: stages whose checks told nothing.
    [[nodiscard]] std::vector<std::string> silent_stages() const;

    /// In words: stages whose checks told nothing, kernels and features that are not tested.
    /// `without`: name as well what was never left out.
    [[nodiscard]] std::vector<std::string> not_tested(bool without) const;

  private:
    bool packets_;
    std::vector<std::string> stages_;  // in the order that they were first checked
    std::set<std::string> told_;       // of these
    // By file and kernel: the defines of each launch that a check told something about.
    std::map<std::pair<std::string, std::string>, std::vector<Defines>> tested_;
};

}  // namespace manylight
