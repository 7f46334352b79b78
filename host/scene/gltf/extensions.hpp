// SPDX-License-Identifier: MIT
// What becomes of a file's extensions.
#pragma once

#include <string>

namespace manylight {

enum class Extension {
    rendered,  // as it says
    dropped,   // changes how a surface looks: the file is shown without it
    silent,    // shows nothing in an image
    unknown    // may mean that the file cannot be read
};

[[nodiscard]] Extension extension_kind(const std::string& name);

/// Whether light goes through surfaces of that extension, as through glass.
[[nodiscard]] bool lets_light_through(const std::string& name);

}  // namespace manylight
