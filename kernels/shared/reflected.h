// SPDX-License-Identifier: MIT
#ifndef MANYLIGHT_SHARED_REFLECTED_H
#define MANYLIGHT_SHARED_REFLECTED_H

#include "shared/types.h"

SHARED_BEGIN

/// What the ray of a pixel sample, drawn from a surface's GGX lobe, has met of area lights.
typedef struct Reflected {
    float4 emission;  // rgb: radiance towards the surface, cd/m2; w: the density of the ray's
                      // direction x the solid angle of the cell that it has met, 0 if none
    float4 fresnel;   // rgb: what microfacets reflect; w: lobe x cosine / density
    uint light;       // that the cell is, or NO_LIGHT
    uint padding0;
    uint padding1;
    uint padding2;
} Reflected;
SHARED_SIZE(Reflected, 48)

SHARED_END

#endif
