// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <string>

namespace manylight {

/// A bar with the time left on standard error. Where that is no terminal, lines instead, for logs:
/// the first after `interval`, the next after twice as long each, but at least every minute.
class Progress {
  public:
    explicit Progress(std::string title, bool quiet = false,
                      std::chrono::milliseconds interval = std::chrono::seconds(10));
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// The share done, 0 to 1; never goes back.
    void set(double share);

    /// From now on set() counts a part of the whole, from one share to another.
    void part(double from, double to);

  private:
    std::string title_;
    bool quiet_;
    bool is_bar_;
    std::chrono::milliseconds interval_;  // between two times
    double share_ = 0;
    double from_ = 0, to_ = 1;  // of the part
    std::chrono::steady_clock::time_point start_, drawn_;
};

}  // namespace manylight
