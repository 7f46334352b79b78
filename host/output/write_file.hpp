// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace manylight {

/// Throws InputError unless `path`, given by `option`, can become a file: its name ends in one of
/// `endings` (each with its dot; none: any), its folder exists and can be written, and what is
/// there now, if anything, is a regular file.
void check_output(const std::string& option, const std::string& path,
                  std::span<const std::string> endings = {});

/// Whether two paths lead to one file, there or not.
[[nodiscard]] bool same_file(const std::string& a, const std::string& b);

/// Writes a whole file: to a name of its own beside the target, flushed to the disk, then renamed,
/// so that an older file stays whole until the new one is. A symbolic link keeps leading to it.
/// Throws RuntimeError, and leaves nothing behind, where that fails or an interrupt ends the
/// process. One thread at a time.
void write_file(const std::string& path, std::span<const std::byte> bytes);

}  // namespace manylight
