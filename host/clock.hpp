// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>

namespace manylight {

using Clock = std::chrono::steady_clock;

[[nodiscard]] inline double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// When the program was started, before its libraries were loaded; now, where the system does not
/// tell (Linux's /proc/self/stat, 10 ms).
[[nodiscard]] Clock::time_point process_start();

}  // namespace manylight
