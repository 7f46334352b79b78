// SPDX-License-Identifier: MIT
#include "output/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace manylight {
namespace {

std::string duration(double seconds) {
    const auto whole = static_cast<long>(std::min(seconds, 1e9));
    if (whole >= 3600) return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
    if (whole >= 60) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
    return fmt::format("{} s", whole);
}

}  // namespace

Progress::Progress(std::string title, bool quiet, std::chrono::milliseconds interval)
    : title_(std::move(title)),
      quiet_(quiet),
      is_bar_(isatty(STDERR_FILENO) != 0),
      interval_(is_bar_ ? std::chrono::milliseconds(100) : interval),
      start_(std::chrono::steady_clock::now()),
      drawn_(start_) {}

Progress::~Progress() {
    if (!quiet_ && is_bar_) fmt::print(stderr, "\r\033[K");
}

void Progress::set(double share) {
    share_ = std::clamp(from_ + share * (to_ - from_), share_, 1.0);
    const auto now = std::chrono::steady_clock::now();
    if (quiet_ || now - drawn_ < interval_) return;
    drawn_ = now;
    const double elapsed = std::chrono::duration<double>(now - start_).count();
    const std::string text =
        fmt::format("{:3.0f}%, {} left", 100 * share_,
                    share_ > 0 ? duration(elapsed * (1 - share_) / share_) : "?");
    if (is_bar_) {
        constexpr int width = 30;
        const int filled = static_cast<int>(share_ * width);
        fmt::print(stderr, "\r{} [{:#<{}}{:.<{}}] {}\033[K", title_, "", filled, "", width - filled,
                   text);
    } else {
        fmt::print(stderr, "{} {}\n", title_, text);
        interval_ = std::min<std::chrono::milliseconds>(2 * interval_, std::chrono::minutes(1));
    }
    std::fflush(stderr);
}

void Progress::part(double from, double to) {
    from_ = from;
    to_ = to;
}

}  // namespace manylight
