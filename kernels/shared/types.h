// SPDX-License-Identifier: MIT
// Scalar and vector types of the structs that host and device share.
//
// Shared structs hold 32-bit scalars and float4 only, so that both compilers lay them out alike;
// SHARED_SIZE states the size to both, and tests probe every offset on the device.
#ifndef MANYLIGHT_SHARED_TYPES_H
#define MANYLIGHT_SHARED_TYPES_H

#ifdef __OPENCL_C_VERSION__

#define SHARED_BEGIN
#define SHARED_END
#define SHARED_SIZE(type, bytes) typedef char type##_size_check[sizeof(type) == (bytes) ? 1 : -1];

#else

#include <cstdint>
#include <glm/vec4.hpp>

#define SHARED_BEGIN namespace manylight {
#define SHARED_END }
#define SHARED_SIZE(type, bytes) static_assert(sizeof(type) == (bytes));

namespace manylight {
using float4 = glm::vec4;
using uint = std::uint32_t;
}  // namespace manylight

#endif

#endif
