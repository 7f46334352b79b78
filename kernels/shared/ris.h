// SPDX-License-Identifier: MIT
#ifndef MANYLIGHT_SHARED_RIS_H
#define MANYLIGHT_SHARED_RIS_H

/// Candidates of a light sample of sampler ris: as many as Bitterli et al., "Spatiotemporal
/// Reservoir Resampling" (2020), 5, take.
#define CANDIDATES 32u

#endif
