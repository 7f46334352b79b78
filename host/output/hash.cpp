// SPDX-License-Identifier: MIT
#include "output/hash.hpp"

#include <OpenImageIO/hash.h>
#include <fmt/format.h>

namespace manylight {

ContentHash& ContentHash::add(std::span<const std::byte> bytes) {
    using OIIO::xxhash::xxhash;
    const std::uint64_t head[] = {state_, bytes.size()};
    const void* start = head;
    state_ =
        xxhash(static_cast<const void*>(bytes.data()), bytes.size(), xxhash(start, sizeof(head)));
    return *this;
}

std::string ContentHash::name() const { return fmt::format("{:016x}", state_); }

}  // namespace manylight
