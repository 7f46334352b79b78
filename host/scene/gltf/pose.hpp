// SPDX-License-Identifier: MIT
// Where the nodes of a glTF file are: at rest, or at a moment of its first animation.
#pragma once

#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <span>
#include <vector>

#include "scene/gltf/accessors.hpp"

namespace manylight {

/// The nodes' transforms and morph weights at a moment. Its world is the file's, counted from
/// `origin`.
class Pose {
  public:
    /// `seconds`: the moment of the first animation, before its first and after its last keyframe
    /// as there; none: at rest. Throws InputError, also where there is no animation.
    Pose(const GltfFile& file, const tinygltf::Model& model, Accessors& accessors,
         std::optional<double> seconds, const glm::dvec3& origin);

    [[nodiscard]] bool is_at_rest() const { return is_at_rest_; }
    /// From a node's frame to the world, m.
    [[nodiscard]] const glm::dmat4& to_world(int node) const { return to_world_[node]; }
    /// Of the morph targets of a node's mesh; may be fewer than these, which then have 0.
    [[nodiscard]] std::span<const float> morph_weights(int node) const { return weights_[node]; }
    /// [joint of the skin] from the bound mesh's frame to the world.
    [[nodiscard]] std::vector<glm::dmat4> joint_matrices(int skin, Accessors& accessors) const;

  private:
    struct Transform {
        glm::dvec3 translation{0};
        glm::dquat rotation{1, 0, 0, 0};
        glm::dvec3 scale{1};
        glm::dmat4 matrix{1};  // on the left of these
        [[nodiscard]] glm::dmat4 whole() const;
    };

    void animate(Accessors& accessors, double seconds, std::vector<Transform>& transforms);
    void place_nodes(const std::vector<Transform>& transforms, const glm::dvec3& origin);

    const GltfFile& file_;
    const tinygltf::Model& model_;
    bool is_at_rest_;
    std::vector<glm::dmat4> to_world_;
    std::vector<std::vector<float>> weights_;
};

/// Writes into the JSON, which has passed check_gltf() and has to pass it again, what the first
/// animation makes of lights, materials, cameras, nodes and meshes that it names by JSON pointers
/// (KHR_animation_pointer). Throws InputError.
void point_animation(GltfFile& file, double seconds);

/// The instances of a node's mesh (EXT_mesh_gpu_instancing), as transforms to the node's frame; the
/// identity alone where it has none.
[[nodiscard]] std::vector<glm::dmat4> mesh_instances(const GltfFile& file, int node,
                                                     Accessors& accessors);
/// How many they are, without reading them.
[[nodiscard]] std::size_t count_instances(const GltfFile& file, int node);

}  // namespace manylight
