// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <string>

namespace manylight {

/// A bar with the time left on standard error; silent unless that is a terminal.
class Progress {
  public:
    explicit Progress(std::string title, bool quiet = false);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// The share done, 0 to 1; never goes back.
    void set(double share);

    /// From now on set() counts a part of the whole, from one share to another.
    void part(double from, double to);

  private:
    std::string title_;
    bool shown_;
    double share_ = 0;
    double from_ = 0, to_ = 1;  // of the part
    std::chrono::steady_clock::time_point start_, drawn_;
};

}  // namespace manylight
