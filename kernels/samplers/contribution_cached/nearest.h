// SPDX-License-Identifier: MIT
// The rows of the nearest clusters.
#ifndef MANYLIGHT_SAMPLERS_CONTRIBUTION_CACHED_NEAREST_H
#define MANYLIGHT_SAMPLERS_CONTRIBUTION_CACHED_NEAREST_H

#include "shared/contribution_cached.h"

typedef struct Nearest {
    uint count;
    uint rows[MOST_NEIGHBOURS + 1];
    float distances2[MOST_NEIGHBOURS + 1];  // squared, ascending, m2
} Nearest;

// Puts a row in its place, of `most` at most.
static void add_row(Nearest* nearest, uint most, uint row, float distance2) {
    if (nearest->count == most) {
        if (distance2 >= nearest->distances2[most - 1u]) return;
        --nearest->count;
    }
    uint at = nearest->count++;
    for (; at > 0u && distance2 < nearest->distances2[at - 1u]; --at) {
        nearest->rows[at] = nearest->rows[at - 1u];
        nearest->distances2[at] = nearest->distances2[at - 1u];
    }
    nearest->rows[at] = row;
    nearest->distances2[at] = distance2;
}

#endif
