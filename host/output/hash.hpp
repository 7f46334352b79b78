// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "scene/scene.hpp"

namespace manylight {

/// A name for contents, for caches: 64 bits, which do not withstand an attacker.
class ContentHash {
  public:
    ContentHash& add(std::span<const std::byte> bytes);
    ContentHash& add(std::string_view text) { return add(std::as_bytes(std::span(text))); }
    template <class T>
    requires std::has_unique_object_representations_v<T> || std::is_floating_point_v<T> ContentHash&
    add(const T& value) {
        return add(std::as_bytes(std::span(&value, 1)));
    }

    /// All that rendering reads of a scene.
    ContentHash& add(const Scene& scene);

    /// 16 hexadecimal digits.
    [[nodiscard]] std::string name() const;

  private:
    std::uint64_t state_ = 0;
};

}  // namespace manylight
