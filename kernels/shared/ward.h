// SPDX-License-Identifier: MIT
#ifndef MANYLIGHT_SHARED_WARD_H
#define MANYLIGHT_SHARED_WARD_H

/// A light's hit history in a tile of the batch, histories[tile * light_count + light]: shadow rays
/// traced + 65536 x rays that passed. It comes from this many probes, each from a pixel of its own
/// sixteenth of the tile to a random point of the light, where the light shines on the pixel at
/// all.
#define WARD_PROBES 16

/// A step of a walk has up to so many packets of 16 rays: the fewer, the more launches of kernels.
#define STEP_PACKETS 4

/// In place of a pixel sample: the random numbers of the probes. Light samples use the pixel
/// sample's own, with the light as their dimension.
#define RANDOM_HISTORIES 0xfffffffbu

/// In place of a light: the random number that shifts the systematic draws of a pixel's tail.
#define RANDOM_TAIL 0xfffffffbu

/// Sampler ward-unbiased draws a light of the tail in proportion to its contribution x sqrt(w (1 -
/// w) + this), where w is its expected visibility. With 0 a light that is thought hidden, or free,
/// would never be looked at.
#define TAIL_DOUBT 0.0625f

#endif
