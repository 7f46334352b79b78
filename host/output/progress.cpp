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

Progress::Progress(std::string title, bool quiet)
    : title_(std::move(title)),
      shown_(!quiet && isatty(STDERR_FILENO)),
      start_(std::chrono::steady_clock::now()),
      drawn_(start_) {}

Progress::~Progress() {
    if (shown_) fmt::print(stderr, "\r\033[K");
}

void Progress::set(double share) {
    share_ = std::clamp(from_ + share * (to_ - from_), share_, 1.0);
    const auto now = std::chrono::steady_clock::now();
    if (!shown_ || now - drawn_ < std::chrono::milliseconds(100)) return;
    drawn_ = now;
    const double elapsed = std::chrono::duration<double>(now - start_).count();
    constexpr int width = 30;
    const int filled = static_cast<int>(share_ * width);
    fmt::print(stderr, "\r{} [{:#<{}}{:.<{}}] {:3.0f}%, {} left\033[K", title_, "", filled, "",
               width - filled, 100 * share_,
               share_ > 0 ? duration(elapsed * (1 - share_) / share_) : "?");
    std::fflush(stderr);
}

void Progress::part(double from, double to) {
    from_ = from;
    to_ = to;
}

}  // namespace manylight
