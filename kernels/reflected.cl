// SPDX-License-Identifier: MIT
// Stage reflections beside samplers whose light samples have no probability in closed form: as if
// there were one on each cell of an area light.
#include "lib/reflected.h"
