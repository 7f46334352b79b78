// SPDX-License-Identifier: MIT
#ifndef MANYLIGHT_SHARED_GROUPS_H
#define MANYLIGHT_SHARED_GROUPS_H

/// Where the error is estimated, pixel sample i belongs to group i % ERROR_GROUPS. Even samples are
/// drawn independently of odd ones (see host/output/error_estimate.hpp).
#define ERROR_GROUPS 4

#endif
