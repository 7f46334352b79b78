// SPDX-License-Identifier: MIT
#ifndef MANYLIGHT_SHARED_LIGHT_CELLS_H
#define MANYLIGHT_SHARED_LIGHT_CELLS_H

#include "shared/types.h"

SHARED_BEGIN

/// How the shape that an emissive triangle is, or is one half of, is cut to cells of equal area,
/// each of which is a light or emits nothing. Cells of a parallelogram are numbered along its first
/// side, row by row. Those of a triangle, whose columns are as many as its rows, too; in a row,
/// each is followed by the one across its long side, if there is one: row j has 2 (columns - j)
/// - 1.
typedef struct CellGrid {
    float4 u;    // x + y a + z b: where along the shape's first side, in columns, the triangle's
                 // point is that has the weights a and b of vertices 1 and 2; w: the LightKind
    float4 v;    // xyz: likewise along the second side, in rows
    float area;  // of each cell, m2
    uint first;  // of its cells in a table of all, LightCells::lights
    uint columns;
    uint rows;
} CellGrid;
SHARED_SIZE(CellGrid, 48)

/// In place of a CellGrid: the triangle is no area light.
#define NO_GRID 0xffffffffu

/// In place of a light: the cell emits nothing.
#define NO_LIGHT 0xffffffffu

SHARED_END

#endif
