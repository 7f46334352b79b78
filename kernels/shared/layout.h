// SPDX-License-Identifier: MIT
// The fields of all shared structs, X(type, field), for comparing their offsets on both sides.
#ifndef MANYLIGHT_SHARED_LAYOUT_H
#define MANYLIGHT_SHARED_LAYOUT_H

#include "shared/adaptive.h"
#include "shared/camera.h"
#include "shared/contribution.h"
#include "shared/emitter_part.h"
#include "shared/instance.h"
#include "shared/light.h"
#include "shared/light_cells.h"
#include "shared/light_tree.h"
#include "shared/material.h"
#include "shared/reflected.h"
#include "shared/surface.h"
#include "shared/texture.h"
#include "shared/tiles.h"

// clang-format off
#define SHARED_FIELDS(X)                                                                           \
    X(Camera, origin) X(Camera, right) X(Camera, up) X(Camera, forward)                            \
    X(Surface, position) X(Surface, normal) X(Surface, horizon) X(Surface, triangle)               \
    X(Surface, material) X(Surface, front) X(Surface, shading)                                     \
    X(Texture, first) X(Texture, width) X(Texture, height) X(Texture, levels) X(Texture, format)   \
    X(Texture, wrap_u) X(Texture, wrap_v) X(Texture, magnified_linear)                             \
    X(Texture, minified_linear) X(Texture, between)                                                \
    X(TextureMap, u) X(TextureMap, v) X(TextureMap, texture) X(TextureMap, set)                    \
    X(TextureMap, scale)                                                                           \
    X(Material, base_color) X(Material, emission) X(Material, roughness) X(Material, specular)     \
    X(Material, reflectance) X(Material, alpha) X(Material, cutoff) X(Material, unlit)             \
    X(Material, culled)                                                                            \
    X(AlphaTriangle, first) X(AlphaTriangle, second) X(AlphaTriangle, alphas)                      \
    X(AlphaTriangle, texture) X(AlphaTriangle, culled)                                             \
    X(Instance, to_world) X(Instance, to_object) X(Instance, first) X(Instance, stored)            \
    X(Instance, mesh) X(Instance, mirrored) X(Instance, root)                                      \
    X(Light, position) X(Light, axis) X(Light, edge) X(Light, emission)                            \
    X(CellGrid, u) X(CellGrid, v) X(CellGrid, area) X(CellGrid, first) X(CellGrid, columns)       \
    X(CellGrid, rows) X(Reflected, emission) X(Reflected, fresnel) X(Reflected, light)             \
    X(Tiles, width) X(Tiles, height) X(Tiles, size) X(Tiles, columns) X(Tiles, first)              \
    X(Tiles, count)                                                                                \
    X(Region, x) X(Region, y) X(Region, size) X(Region, level) X(Region, first_sibling)            \
    X(Region, siblings)                                                                            \
    X(RowSum, visible) X(RowSum, unshadowed) X(RowSum, visible_count) X(RowSum, facing_count)      \
    X(LightNode, centre) X(LightNode, axis) X(LightNode, intensity) X(LightNode, lower)            \
    X(LightNode, upper) X(LightNode, cone) X(LightNode, first) X(LightNode, count)                 \
    X(LightNode, reach) X(LightNode, kind) X(Trials, traced) X(Trials, passed)                     \
    X(Pass, first) X(Pass, count) X(Pass, number) X(Pass, first_tile) X(Pass, tile_count)          \
    X(Pass, packets) X(Budget, samples) X(Budget, factor) X(Budget, exposure)                      \
    X(Expectation, variance) X(Expectation, luminance)                                             \
    X(EmitterPart, corner) X(EmitterPart, way_2) X(EmitterPart, covered) X(EmitterPart, triangle)  \
    X(EmitterPart, pixel)                                                                          \
    X(Mixture, visible) X(Mixture, unshadowed) X(Mixture, power) X(Mixture, total_power)
// clang-format on

#endif
