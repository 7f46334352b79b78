// SPDX-License-Identifier: MIT
#include "clock.hpp"

#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>

namespace manylight {

Clock::time_point process_start() {
    const auto now = Clock::now();
    std::ifstream file("/proc/self/stat");
    std::string text;
    std::getline(file, text);
    // The name, in parentheses, may hold blanks; 20 fields follow until the one that is wanted.
    std::istringstream fields(text.substr(std::min(text.rfind(')') + 1, text.size())));
    std::string field;
    for (int i = 0; i < 19; ++i) fields >> field;
    double ticks = 0;
    timespec since_boot{};
    if (!(fields >> ticks) || clock_gettime(CLOCK_BOOTTIME, &since_boot) != 0) return now;
    const double uptime =
        static_cast<double>(since_boot.tv_sec) + 1e-9 * static_cast<double>(since_boot.tv_nsec);
    const double age = uptime - ticks / static_cast<double>(sysconf(_SC_CLK_TCK));
    if (!(age > 0)) return now;
    return now - std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(age));
}

}  // namespace manylight
