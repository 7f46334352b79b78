// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <glm/glm.hpp>
#include <limits>
#include <optional>
#include <vector>

#include "scene/scene.hpp"

namespace manylight::reference {

/// A segment origin + t direction, start < t < end, in double precision.
struct Ray {
    glm::dvec3 origin;
    glm::dvec3 direction;
    double end = std::numeric_limits<double>::infinity();
    double start = 0;
    // From a pixel to its right and to its lower neighbour, where the ray is a pixel's.
    glm::dvec3 origin_change[2] = {glm::dvec3(0), glm::dvec3(0)};
    glm::dvec3 direction_change[2] = {glm::dvec3(0), glm::dvec3(0)};
};

/// By how much rounding may move a segment's ends, along each axis, m; where it is infinite, `end`
/// is by how much its direction.
struct EndShifts {
    glm::dvec3 origin{0}, end{0};
};

struct Hit {
    uint triangle;
    double t, u, v;  // u, v: weights of vertices 1 and 2
};

/// Traces rays in double precision through a plain binary tree of its own (median splits).
class Tracer {
  public:
    explicit Tracer(const Scene& scene);

    [[nodiscard]] std::optional<Hit> closest_hit(const Ray& ray) const;
    [[nodiscard]] bool occluded(const Ray& ray) const { return closest_hit(ray).has_value(); }

    /// Where a ray hits one triangle.
    [[nodiscard]] std::optional<Hit> hit_of(uint triangle, const Ray& ray) const;

    /// Where a ray meets a triangle's plane, in the triangle or beyond its edges by no more than
    /// single precision makes of it (kernels/lib/block.h), so that no ray passes between two
    /// triangles that share an edge.
    [[nodiscard]] std::optional<Hit> hit_near(uint triangle, const Ray& ray) const;

    /// The same by testing every triangle: what the tree itself is checked against.
    [[nodiscard]] std::optional<Hit> closest_hit_of_all(const Ray& ray) const;

    /// Rays that single precision cannot tell from `ray`: its ends are moved by up to `shifts`.
    [[nodiscard]] static std::vector<Ray> neighbours(const Ray& ray, EndShifts shifts);

    /// Whether single precision decides if the ray is occluded: some neighbour is and some is not,
    /// or no triangle is surely hit and one may be, near an edge or near the ray's ends, as far as
    /// rounding goes in the test of a triangle of its shape. The kernels' test passes over what is
    /// nearer to an end than that, so that no surface occludes its own points.
    [[nodiscard]] bool occlusion_is_borderline(const Ray& ray, EndShifts shifts) const;

  private:
    [[nodiscard]] bool is_there(const Ray& ray, const Hit& hit) const;
    struct Node {
        glm::dvec3 lower, upper;
        uint begin, end;            // of order_
        double stretch;             // the most of its triangles' lengths over their heights
        int left = -1, right = -1;  // nodes; -1 for a leaf
    };
    int build(uint begin, uint end);
    void test(uint triangle, const Ray& ray, std::optional<Hit>& best) const;
    // A hit of a triangle's plane, and what rounding may do to it.
    struct RoundedHit {
        Hit hit;
        double beyond;  // weights may be so far outside, and it is hit
        double moved;   // by how much t may be another one, an instance's, as the ray is rounded in
                        // its frame
        // Where t is below `start`, or above the ray's end times 1 - `before_end` less `start`, the
        // kernels may pass over it.
        double start, before_end;
        // By how much all weights are inside.
        [[nodiscard]] double inside() const { return std::min({hit.u, hit.v, 1 - hit.u - hit.v}); }
        [[nodiscard]] bool may_occlude(double end) const {
            return inside() >= -beyond && hit.t > -moved && hit.t < end + moved;
        }
        [[nodiscard]] bool surely_occludes(double end) const {
            return inside() > beyond && hit.t > start && before_end < 1 &&
                   hit.t < end * (1 - before_end) - start;
        }
    };
    [[nodiscard]] std::optional<RoundedHit> meet_plane(uint triangle, const Ray& ray) const;
    [[nodiscard]] bool rounding_decides(const Ray& ray) const;

    const Scene& scene_;
    std::vector<uint> order_;  // triangles
    std::vector<Node> nodes_;
    int root_ = -1;
};

}  // namespace manylight::reference
