// SPDX-License-Identifier: MIT
#pragma once

#include "scene/gltf/file.hpp"

namespace manylight {

/// Changes the JSON, which check_gltf() has passed, to glTF that says what the file means: where it
/// breaks the specification (and warns), by the extensions that hide nodes and choose materials,
/// and where its materials are of specular and glossiness. Throws InputError for a variant that
/// there is not; empty: none.
void mend_gltf(GltfFile& file, const std::string& variant);

}  // namespace manylight
