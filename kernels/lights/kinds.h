// SPDX-License-Identifier: MIT
// The kinds of light, a file each. Included once for every use, which it compiles alone:
// FOR_RECEIVER 1: what a receiver sees of a light, light_<kind>() (lib/lights.h);
// FOR_LANES 1: what LANES receivers see of a light each, light_<kind>_n() (lib/direct_n.h);
// FOR_NODES 1: what leaves of the light tree emit (lib/node_estimate.h).
#include "lights/punctual.h"

#include "lights/cosine.h"

#include "lights/area.h"

#include "lights/directional.h"
#include "lights/oriented.h"
#include "lights/point.h"
#include "lights/quad.h"
#include "lights/spot.h"
#include "lights/triangle.h"
