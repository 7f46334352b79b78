// SPDX-License-Identifier: MIT
#pragma once

#include "scene/gltf/loading.hpp"

namespace manylight {

/// What a scene takes to store and to load, and which of its meshes are stored once.
class Storage {
  public:
    /// Chooses these, once the materials are there. Throws InputError for scenes that cannot fit or
    /// take too long to read.
    explicit Storage(const Loading& in);

    /// Whether a mesh is stored once, as far as its instances allow.
    [[nodiscard]] bool is_shared(int mesh) const { return is_shared_[mesh]; }

    /// Counts further copies of a node's mesh. Throws as the constructor does.
    void add_copies(int node, std::size_t copies);

    /// Vertices and triangles that were expected to be stored at first.
    [[nodiscard]] double expected() const { return expected_; }

    /// Bytes of memory that are left for textures.
    [[nodiscard]] std::size_t bytes_left() const;

  private:
    struct Size {
        double vertices = 0, triangles = 0;
        [[nodiscard]] double bytes() const;
    };

    [[nodiscard]] std::size_t most_bytes() const;
    [[nodiscard]] double steps_of(int node) const;
    [[nodiscard]] Size size_of(int mesh) const;
    [[nodiscard]] bool is_rigid_and_dark(int mesh) const;
    void choose_shared();
    void count_copies(int node, double copies);
    void count_all();
    [[nodiscard]] double needed_bytes() const;
    void check_size() const;

    const Loading& in_;
    std::vector<bool> is_shared_;  // [mesh]
    Size stored_;                  // or what will be
    double instances_ = 0;         // that share these
    double most_places_ = 0;       // of a node, which are read at once
    double steps_ = 0;             // of the loops that read them
    double expected_ = 0;
};

}  // namespace manylight
