// SPDX-License-Identifier: MIT
#ifndef MANYLIGHT_SHARED_CONTRIBUTION_CACHED_H
#define MANYLIGHT_SHARED_CONTRIBUTION_CACHED_H

/// Clusters near a cluster that its pixels choose from: on a grid those all around it.
#define MOST_NEIGHBOURS 8

/// Where a cluster has fewer.
#define NO_ROW 0xffffffffu

#endif
