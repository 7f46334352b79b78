// SPDX-License-Identifier: MIT
#pragma once

#include <map>

#include "scene/gltf/meshes.hpp"
#include "scene/gltf/storage.hpp"

namespace manylight {

/// Puts meshes where the nodes say: copies of them, or instances of those that are stored once.
class Instances {
  public:
    Instances(Loading& in, Storage& storage, MeshReader& meshes);

    /// Adds a node's mesh wherever it is. Throws InputError.
    void add(int node);

    /// Stores the meshes that have instances, behind all others, and completes these. To be called
    /// once, after all nodes were added. Throws InputError.
    void add_shared_meshes();

  private:
    [[nodiscard]] const glm::dvec3& centre_of(int node);
    [[nodiscard]] bool can_be_instance(int mesh, const glm::dmat3& m) const;

    Loading& in_;
    Storage& storage_;
    MeshReader& meshes_;
    std::map<int, glm::dvec3> centres_;  // of shared meshes that have instances
};

}  // namespace manylight
