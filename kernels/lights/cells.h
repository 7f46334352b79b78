// SPDX-License-Identifier: MIT
// Which cell of an area light a point of an emissive triangle is on.
#ifndef MANYLIGHT_LIGHTS_CELLS_H
#define MANYLIGHT_LIGHTS_CELLS_H

#include "lib/common.h"
#include "shared/light.h"
#include "shared/light_cells.h"

// The number of the cell (shared/light_cells.h) of the point that has `weights` of vertices 1
// and 2. On a common edge it is one of the two.
static uint cell_of(__global const CellGrid* grid, float2 weights) {
    const float3 w = (float3)(1.0f, weights);
    const float s = max(dot(grid->u.xyz, w), 0.0f);
    const float t = max(dot(grid->v.xyz, w), 0.0f);
    const uint row = (uint)min(t, (float)(grid->rows - 1u));
    const uint last = grid->columns - 1u;
    if ((uint)grid->u.w == LIGHT_QUAD) return row * grid->columns + (uint)min(s, (float)last);
    const uint column = (uint)min(s, (float)(last - row));
    const bool across =
        row + column + 1u < grid->columns && (s - (float)column) + (t - (float)row) > 1.0f;
    return row * (2u * grid->columns - row) + 2u * column + (across ? 1u : 0u);
}

#endif
