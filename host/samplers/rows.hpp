// SPDX-License-Identifier: MIT
// The list of samplers, in the order of help and charts: the one place that names them all. For
// each, host/samplers/ has sampler_NAME(), its row, and host/verify/samplers/ has checks_NAME().
#pragma once

#define MANYLIGHT_SAMPLERS(ROW) \
    ROW(exhaustive)             \
    ROW(uniform)                \
    ROW(power)                  \
    ROW(ris)                    \
    ROW(lighttree)              \
    ROW(stochastic_lightcuts)   \
    ROW(adaptive)               \
    ROW(contribution)           \
    ROW(contribution_defensive) \
    ROW(contribution_cached)    \
    ROW(octree)                 \
    ROW(octree_virtual)         \
    ROW(ward)                   \
    ROW(ward_unbiased)
