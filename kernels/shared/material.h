// SPDX-License-Identifier: MIT
#ifndef MANYLIGHT_SHARED_MATERIAL_H
#define MANYLIGHT_SHARED_MATERIAL_H

#include "shared/types.h"

SHARED_BEGIN

/// glTF's metallic-roughness material with the factor of KHR_materials_specular.
typedef struct Material {
    float4 base_color;   // rgb: linear; w: metallic, 0 to 1
    float4 emission;     // rgb: radiance, cd/m2, emitted by the front side; w: 1 if both sides emit
    float4 reflectance;  // rgb: of the dielectric, at normal incidence, for `specular` 1; above 1
                         // only where it is still to be multiplied by a texture
    float roughness;     // GGX alpha, at least SMALLEST_ALPHA
    float specular;      // 0 to 1; a material with metallic and specular 0 is Lambert's
    float alpha;         // 0 to 1: coverage
    float cutoff;        // above 0: glTF's alpha cutoff, coverage is 1 where alpha reaches it, else
                         // 0 (MASK); below 0: coverage is alpha (BLEND); 0: it is 1 (OPAQUE)
    uint unlit;          // 1: the emission is its colour and gives no light
    uint culled;         // 1: rays pass through its back
    uint padding1;
    uint padding2;
} Material;
SHARED_SIZE(Material, 80)

/// Reflectance at normal incidence of a dielectric with the index of refraction 1.5.
#define USUAL_REFLECTANCE 0.04f

/// Below this GGX alpha, single precision cannot resolve the lobe (1 - cos of its width is 1e-6).
#define SMALLEST_ALPHA 1e-3f

/// Below this GGX alpha, stage reflections takes part in what a material reflects of area lights.
/// Above, its rays cost more than they gain (docs/reflections.md).
#define REFLECTING_ALPHA 0.03f

SHARED_END

#endif
