// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "reference/samples.hpp"
#include "shared/octree.h"

namespace manylight::reference {

/// Radiance reflected to the camera per intensity, without visibility, 1/(m2 sr): between `least`
/// and `most` for every light of a node and every point of it, and `estimate` of its virtual light.
struct NodeBounds {
    glm::dvec3 least, most, estimate;
    bool doubtful;  // rounding may have made `least` 0, or not
};

/// Bounds of an octree's inner node, of positions and emission axes that its radius and cone allow;
/// `most` is infinite where the point is among the lights.
///
/// Paquette, Poulin, Drettakis (1998) bound Lambert's and Phong's reflection of point lights. Here
/// also lights of all kinds, and GGX: D by how far the half vector may turn towards the normal and
/// from it, which is the spread of directions / (2 cos(difference angle)) at most, Smith's factor
/// times the cosine by the cosine, Fresnel's factor by the difference angle.
[[nodiscard]] NodeBounds bound_node(const OctreeNode& node, const Point& point);

/// Sampler octree: see host/samplers/octree/octree.hpp.
class Octree : public Sampler {
  public:
    Octree(std::span<const OctreeNode> nodes, double epsilon, bool to_virtual)
        : nodes_(nodes), epsilon_(epsilon), to_virtual_(to_virtual) {}

    [[nodiscard]] Estimate estimate(const Tracer& tracer, const Point& point,
                                    const PixelDraws& draws) const override;

    /// What errors are relative to: the light of all lights without shadows, about, cd/m2.
    [[nodiscard]] glm::dvec3 total(const Point& point) const;

    /// The nodes that the pixel of a point sends rays to. `undecided`, where given, gets how many
    /// nodes rounding may have taken for others.
    [[nodiscard]] std::vector<uint> cut(const Point& point, int* undecided = nullptr) const;

  private:
    struct Term {
        glm::dvec3 value;  // cd/m2, where nothing is in the way
        double slack;      // of rounding, where asked for
        Ray shadow;
        EndShifts rounding;
        bool borderline;  // rounding may have drawn another light
    };
    [[nodiscard]] bool is_leaf(uint node) const { return nodes_[node].next == node + 1; }
    [[nodiscard]] Term draw(const Point& point, uint node, const PixelDraws& draws) const;
    [[nodiscard]] Term shade_virtual(const Point& point, uint node, bool judge) const;

    std::span<const OctreeNode> nodes_;
    double epsilon_;
    bool to_virtual_;
};

}  // namespace manylight::reference
