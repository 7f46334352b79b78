// SPDX-License-Identifier: MIT
// Stage contributions: the cluster x light matrix of C(a, y), paper eq. (4) and (5).
#include "lib/direct.h"
#include "lib/rays.h"
#include "shared/contribution.h"
#include "shared/tiles.h"

// contributions[row * light_count + light], cd/m2 (luminance): what the light would contribute to
// the row's representative with V = 1, judged by its centroid; and the ray that has to be free.
// Rows are cut to packets of 16 lights; item i is lane i % 16 of packet i / 16, the first of which
// is first_row's first.
KERNEL void contributions_aim(VIEW_PARAMETERS, __global const Surface* surfaces,
                              __global const Material* materials, __global const Light* lights,
                              uint light_count, __global const uint* representatives,
                              uint first_row, uint row_count, __global float* contributions,
                              __global float4* origins, __global float* rays) {
    const uint packets = (light_count + 15u) / 16u;  // of a row
    const uint packet = (uint)get_global_id(0) / 16u;
    const uint lane = (uint)get_global_id(0) % 16u;
    if (packet >= row_count * packets) return;
    const uint row = first_row + packet / packets;
    const uint light = packet % packets * 16u + lane;
    const uint representative = representatives[row];
    RAY_END(rays, packet, lane) = 0.0f;
    if (light >= light_count) return;
    float value = 0.0f;
    if (representative != NO_ITEM) {
        const Receiver receiver = make_receiver(surfaces, representative, materials, VIEW);
        Ray shadow;
        const float2 u = light_centroid(lights + light);
        value = luminance(unshadowed(&receiver, lights + light, u, &shadow));
        if (value > 0.0f) put_ray(rays, packet, lane, shadow);
        if (lane == 0u) origins[packet] = (float4)(shadow_origin(&receiver), 0.0f);
    }
    contributions[(ulong)row * light_count + light] = value;
}

// Makes the contributions negative whose rays are occluded; items as above.
KERNEL void contributions_hide(uint light_count, uint first_row, uint row_count,
                               __global const float* rays, __global float* contributions) {
    const uint packets = (light_count + 15u) / 16u;
    const uint packet = (uint)get_global_id(0) / 16u;
    const uint lane = (uint)get_global_id(0) % 16u;
    if (packet >= row_count * packets || RAY_END(rays, packet, lane) >= 0.0f) return;
    const ulong row = first_row + packet / packets;
    const uint light = packet % packets * 16u + lane;
    contributions[row * light_count + light] = -contributions[row * light_count + light];
}

// sums[row * chunks + chunk]: one work-item adds up LIGHT_CHUNK lights of a row, in order.
KERNEL void contributions_sum(__global const float* contributions, uint light_count, uint first_row,
                              uint row_count, __global RowSum* sums) {
    const uint chunks = (light_count + LIGHT_CHUNK - 1u) / LIGHT_CHUNK;
    const uint row = (uint)(get_global_id(0) / max(chunks, 1u));
    if (row >= row_count) return;
    const uint chunk = (uint)(get_global_id(0) % chunks);
    const uint end = min((chunk + 1u) * LIGHT_CHUNK, light_count);
    __global const float* values = contributions + (ulong)(first_row + row) * light_count;
    RowSum sum = {0.0f, 0.0f, 0u, 0u};
    for (uint light = chunk * LIGHT_CHUNK; light < end; ++light) {
        const float value = values[light];
        sum.unshadowed += fabs(value);
        sum.visible += max(value, 0.0f);
        sum.visible_count += value > 0.0f ? 1u : 0u;
        sum.facing_count += value != 0.0f ? 1u : 0u;
    }
    sums[(first_row + row) * chunks + chunk] = sum;
}

// totals[row]: the row's chunks added up, in order.
KERNEL void contributions_total(__global const RowSum* sums, uint chunks, uint first_row,
                                uint row_count, __global RowSum* totals) {
    const uint item = get_global_id(0);
    if (item >= row_count) return;
    const uint row = first_row + item;
    RowSum total = {0.0f, 0.0f, 0u, 0u};
    for (uint chunk = 0u; chunk < chunks; ++chunk) {
        const RowSum sum = sums[row * chunks + chunk];
        total.visible += sum.visible;
        total.unshadowed += sum.unshadowed;
        total.visible_count += sum.visible_count;
        total.facing_count += sum.facing_count;
    }
    totals[row] = total;
}
