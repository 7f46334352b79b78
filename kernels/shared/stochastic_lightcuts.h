// SPDX-License-Identifier: MIT
#ifndef MANYLIGHT_SHARED_STOCHASTIC_LIGHTCUTS_H
#define MANYLIGHT_SHARED_STOCHASTIC_LIGHTCUTS_H

/// Nodes of a pixel's cut at most, a multiple of the 16 samples of a launch: further light samples
/// have another cut. Yuksel's cuts have 1 to 32 nodes, and Lin's and Yuksel's up to 8.
#define MOST_CUT_NODES 32

/// In place of a node: that above the two roots of a scene with directional and other lights.
#define BOTH_ROOTS 0xffffffffu

#endif
