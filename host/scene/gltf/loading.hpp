// SPDX-License-Identifier: MIT
// What the parts of load_scene() share.
#pragma once

#include "scene/gltf/load.hpp"
#include "scene/gltf/pose.hpp"

namespace manylight {

/// Beyond these, sums and squares in single precision would overflow. The sun's disc has 1.6e9
/// cd/m2.
constexpr float brightest = 1e15f;  // cd, lx or cd/m2
constexpr float farthest = 1e9f;    // m

/// A file on the way to a scene.
struct Loading {
    /// Parses the file, which has passed check_gltf(), and poses its nodes. `origin`:
    /// Scene::origin. File and options live longer.
    Loading(const GltfFile& file, const LoadOptions& options, const glm::dvec3& origin);

    /// Throw InputError for what is brighter or farther, naming what has it.
    void check_brightness(const glm::vec3& rgb, const std::string& where) const;
    void check_transform(const glm::dmat4& to_world, int node) const;

    const GltfFile& file;
    const LoadOptions& options;
    tinygltf::Model model;
    Accessors accessors;
    Pose pose;
    std::vector<int> nodes;  // of the file's scene, parents first
    Scene scene;             // what there is of it
    Notes notes;
};

}  // namespace manylight
