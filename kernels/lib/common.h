// SPDX-License-Identifier: MIT
// Included first by every kernel.
#ifndef MANYLIGHT_LIB_COMMON_H
#define MANYLIGHT_LIB_COMMON_H

// Discrete decisions (quadtree splits, CDF steps) must agree with the scalar reference, so no
// multiply and add is fused unless the code says fma().
#pragma OPENCL FP_CONTRACT OFF

// Processors without the instruction would call a function for each number.
#if defined(__x86_64__) && !defined(__FMA__)
#define fma(a, b, c) ((a) * (b) + (c))
#endif

// Every kernel is launched with this local size; PoCL compiles again for any other.
#define KERNEL __kernel __attribute__((reqd_work_group_size(LOCAL_SIZE, 1, 1)))

// Luminance of linear Rec. 709 (ITU-R BT.709-6, 3.2).
static float luminance(float3 color) {
    return 0.2126f * color.x + 0.7152f * color.y + 0.0722f * color.z;
}

#endif
