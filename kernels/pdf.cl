// SPDX-License-Identifier: MIT
// Stage pdf: rows of the contribution matrix to CDFs, in place (paper 4.2, eq. (6)).
//
// cdf[row * light_count + light]: the integer widths (shared/contribution.h) of lights 0..light
// added up; the last entry of a row is its total, 0 where no light has a chance.
#include "lib/common.h"
#include "shared/contribution.h"
#include "shared/light.h"

// share / total, or 0 where there is nothing to share.
static float part(float share, float total) { return total > 0.0f ? share / total : 0.0f; }

static uint width(float contribution, float power, float per_visible, float per_unshadowed,
                  float per_power) {
    const float p = max(contribution, 0.0f) * per_visible + fabs(contribution) * per_unshadowed +
                    power * per_power;
    return p > 0.0f ? max((uint)(p * CDF_SCALE), 1u) : 0u;
}

// One work-item turns a chunk of a row to the running sums of its widths, from 0.
KERNEL void pdf_quantise(__global uint* cdf, __global const Light* lights, uint light_count,
                         uint row_count, __global const RowSum* totals, Mixture mixture,
                         __global uint* chunk_sums) {
    const uint chunks = (light_count + LIGHT_CHUNK - 1u) / LIGHT_CHUNK;
    const uint row = (uint)(get_global_id(0) / max(chunks, 1u));
    if (row >= row_count) return;
    const uint chunk = (uint)(get_global_id(0) % chunks);
    const RowSum total = totals[row];
    const float whole = (total.visible > 0.0f ? mixture.visible : 0.0f) +
                        (total.unshadowed > 0.0f ? mixture.unshadowed : 0.0f) +
                        (mixture.total_power > 0.0f ? mixture.power : 0.0f);
    const float per_visible = part(part(mixture.visible, total.visible), whole);
    const float per_unshadowed = part(part(mixture.unshadowed, total.unshadowed), whole);
    const float per_power = part(part(mixture.power, mixture.total_power), whole);
    __global uint* values = cdf + (ulong)row * light_count;
    const uint end = min((chunk + 1u) * LIGHT_CHUNK, light_count);
    uint sum = 0u;
    for (uint light = chunk * LIGHT_CHUNK; light < end; ++light) {
        sum += width(as_float(values[light]), lights[light].emission.w, per_visible, per_unshadowed,
                     per_power);
        values[light] = sum;
    }
    chunk_sums[row * chunks + chunk] = sum;
}

// chunk_sums[row * chunks + chunk]: the sums of a row's chunks to the sum before each.
KERNEL void pdf_scan(uint chunks, uint row_count, __global uint* chunk_sums) {
    const uint row = get_global_id(0);
    if (row >= row_count) return;
    uint before = 0u;
    for (uint chunk = 0u; chunk < chunks; ++chunk) {
        const uint sum = chunk_sums[row * chunks + chunk];
        chunk_sums[row * chunks + chunk] = before;
        before += sum;
    }
}

// Adds to each chunk of a row the sum before it.
KERNEL void pdf_add(__global uint* cdf, uint light_count, uint row_count,
                    __global const uint* chunk_sums) {
    const uint chunks = (light_count + LIGHT_CHUNK - 1u) / LIGHT_CHUNK;
    const uint row = (uint)(get_global_id(0) / max(chunks, 1u));
    if (row >= row_count) return;
    const uint chunk = (uint)(get_global_id(0) % chunks);
    const uint end = min((chunk + 1u) * LIGHT_CHUNK, light_count);
    for (uint light = chunk * LIGHT_CHUNK; light < end; ++light)
        cdf[(ulong)row * light_count + light] += chunk_sums[row * chunks + chunk];
}
