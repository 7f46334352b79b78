// SPDX-License-Identifier: MIT
// What a driver makes of shared structs and random numbers; used by verify and the tests only.
#include "lib/random.h"
#include "lights/cells.h"
#include "shared/layout.h"

// offsets[i]: byte offset of the i-th of SHARED_FIELDS.
KERNEL void probe_layout(__global uint* offsets) {
    if (get_global_id(0) != 0) return;
    uint i = 0u;
#define PROBE(type, field)                                              \
    {                                                                   \
        type probed;                                                    \
        offsets[i++] = (uint)((uchar*)&probed.field - (uchar*)&probed); \
    }
    SHARED_FIELDS(PROBE)
#undef PROBE
}

// bits[i]: random_bits of pixel i; positions[i]: pixel_position of sample i of pixel i / 16.
KERNEL void probe_random(uint count, uint seed, __global uint4* bits, __global float2* positions) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    bits[i] = random_bits(i, i ^ 5u, i * 7u, seed);
    positions[i] = pixel_position(i / 16u, i, seed);
}

// cells[i]: of the point of grid i / 64 that has the i-th weights.
KERNEL void probe_cells(uint count, __global const CellGrid* grids, __global const float2* weights,
                        __global uint* cells) {
    const uint i = get_global_id(0);
    if (i < count) cells[i] = cell_of(grids + i / 64u, weights[i]);
}
