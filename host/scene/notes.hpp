// SPDX-License-Identifier: MIT
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

namespace manylight {

/// What was read otherwise than a file says, or left out: one line for all places of a kind.
class Notes {
  public:
    /// `place`: the object's path in the JSON; `what`: what is so there, and what became of it.
    void add(const std::string& place, const std::string& what) {
        auto found = std::ranges::find(notes_, what, &Note::what);
        if (found == notes_.end()) found = notes_.insert(found, {what, place, {}});
        found->places.insert(place);
    }
    [[nodiscard]] std::vector<std::string> lines(const std::string& file) const {
        std::vector<std::string> out;
        for (const Note& note : notes_) {
            const std::size_t more = note.places.size() - 1;
            const std::string others = more == 0 ? "" : fmt::format(" (and {} more)", more);
            out.push_back(fmt::format("{}: {}{} {}", file, note.first, others, note.what));
        }
        return out;
    }

  private:
    struct Note {
        std::string what;
        std::string first;
        std::set<std::string> places;
    };
    std::vector<Note> notes_;
};

}  // namespace manylight
