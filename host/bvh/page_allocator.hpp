// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <new>

namespace manylight {

/// Allocates whole pages: devices that work on the host's memory need no copy of what lies there.
template <class T>
struct PageAllocator {
    using value_type = T;
    static constexpr std::align_val_t page{4096};
    PageAllocator() = default;
    template <class U>
    PageAllocator(const PageAllocator<U>&) {}  // NOLINT: allocators convert
    T* allocate(std::size_t count) {
        return static_cast<T*>(::operator new((count * sizeof(T) + 4095) / 4096 * 4096, page));
    }
    void deallocate(T* memory, std::size_t) { ::operator delete(memory, page); }
    bool operator==(const PageAllocator&) const = default;
};

}  // namespace manylight
