// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>

namespace manylight {

/// Throws InputError unless `path`, given by `option`, can become the folder of a chart: the folder
/// around it exists and can be written, and what is there now, if anything, is an empty folder or
/// one that holds nothing but an older chart (the files that its chart.json lists).
void check_chart_folder(const std::string& option, const std::string& path);

/// Makes the folder: beside the target, filled by `fill` (its argument: where), then exchanged with
/// what is there, which is removed. An older chart stays whole until then. Throws RuntimeError, and
/// leaves nothing behind, where that fails.
void write_chart_folder(const std::string& path,
                        const std::function<void(const std::string&)>& fill);

}  // namespace manylight
