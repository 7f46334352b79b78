// SPDX-License-Identifier: MIT
// Small scenes that together use all that kernels can do, made in memory.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace manylight {

struct VerifyScene {
    std::string name;
    std::string summary;
    Scene scene;  // its lights are complete
    View view;    // in perspective
};

/// The scenes that `verify` judges kernels on where no file is given. Together they hold all kinds
/// of light, of texture, of alpha and of instance (tests/verify_test.cpp has the list).
[[nodiscard]] std::vector<VerifyScene> verify_scenes();

/// The same camera without perspective.
[[nodiscard]] View without_perspective(View view);

/// A floor below a shade that is there by `alpha`, and a point light above the shade; all of the
/// view, from above, is shade.
[[nodiscard]] VerifyScene blend_scene(float alpha);

}  // namespace manylight
