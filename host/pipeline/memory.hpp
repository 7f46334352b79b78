// SPDX-License-Identifier: MIT
// What a frame allocates on the device, against its plan.
#pragma once

#include <array>
#include <memory>
#include <string>

#include "device/device.hpp"
#include "pipeline/plan.hpp"

namespace manylight {

/// One part of a frame.
struct PartMemory {
    std::string part;
    std::size_t planned;  // bytes
    std::shared_ptr<MemoryUse> use = std::make_shared<MemoryUse>();

    /// Throws std::logic_error if there was more at any one time than planned: a budget (--memory)
    /// would not hold.
    void check() const;
};

/// All parts of a frame.
struct FrameMemory {
    /// `sampler`: its name.
    FrameMemory(const Plan& plan, std::string_view sampler);

    PartMemory scene;    // with the materials of a batch's points, which lie behind its own
    PartMemory image;    // sums over pixel samples
    PartMemory pixels;   // a batch's surfaces and estimates
    PartMemory sampler;  // all that it draws from, and its rays in work

    [[nodiscard]] std::array<const PartMemory*, 4> parts() const {
        return {&scene, &image, &pixels, &sampler};
    }
    void check() const {
        for (const PartMemory* part : parts()) part->check();
    }
};

}  // namespace manylight
