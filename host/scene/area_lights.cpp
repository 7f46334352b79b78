// SPDX-License-Identifier: MIT
#include "scene/area_lights.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

namespace manylight {
namespace {

// How far, relative to its shorter side, a parallelogram's corners may be off.
constexpr double corner_tolerance = 1e-4;
// A length that exceeds another by less than this part is not longer, but rounded.
constexpr double rounded = 1 + 1e-4;

// A triangle or a parallelogram of two, one light before it is cut.
struct Shape {
    LightKind kind;
    glm::dvec3 corner, u, v;  // the sides at the corner; it faces cross(u, v)
    float offset;             // as an emitter's
    std::size_t emitter;      // of the shape's radiance
};

// An edge of an emitter, as it winds; a neighbour that faces the same way has its reverse.
struct Edge {
    glm::vec3 from, to;
    std::uint32_t material;
    bool operator==(const Edge&) const = default;
};

Edge edge_of(const Emitter& e, int k) {
    return {e.vertices[k], e.vertices[(k + 1) % 3], e.material};
}

// Edges by where they are. Open addressing: a million triangles have three million edges.
class EdgeTable {
  public:
    struct Side {
        std::size_t emitter;
        int k;
    };

    explicit EdgeTable(const std::vector<Emitter>& emitters)
        : emitters_(emitters), slots_(std::bit_ceil(6 * emitters.size() + 1)) {}

    /// Which emitter's edge was put last of those that are equal to `edge`, if any was.
    [[nodiscard]] std::optional<Side> find(const Edge& edge) const {
        const Slot& slot = slots_[slot_of(edge)];
        if (!slot.used) return {};
        return slot.side;
    }

    void put(const Side& side) {
        const Edge edge = edge_of(emitters_[side.emitter], side.k);
        slots_[slot_of(edge)] = {side, hash_of(edge), true};
    }

  private:
    struct Slot {
        Side side;
        std::uint32_t hash;
        bool used;
    };

    static std::uint32_t hash_of(const Edge& edge) {
        std::uint64_t hash = edge.material;
        for (const glm::vec3& p : {edge.from, edge.to})
            for (int axis = 0; axis < 3; ++axis) {
                const float x = p[axis] + 0.f;  // -0 is equal to 0
                hash = (hash ^ std::bit_cast<std::uint32_t>(x)) * 0x9e3779b97f4a7c15u;
                hash ^= hash >> 32;
            }
        return static_cast<std::uint32_t>(hash);
    }

    // The edge's slot, or the free one that it would take.
    [[nodiscard]] std::size_t slot_of(const Edge& edge) const {
        const std::uint32_t hash = hash_of(edge);
        const std::size_t mask = slots_.size() - 1;
        std::size_t i = hash & mask;
        const auto taken = [&](const Slot& slot) {
            return slot.used && (slot.hash != hash ||
                                 edge_of(emitters_[slot.side.emitter], slot.side.k) != edge);
        };
        while (taken(slots_[i])) i = (i + 1) & mask;
        return i;
    }

    const std::vector<Emitter>& emitters_;
    std::vector<Slot> slots_;
};

double length_of(const Edge& edge) { return glm::distance(edge.from, edge.to); }

bool is_longest(const Emitter& e, int k) {
    const double length = length_of(edge_of(e, k));
    return std::max(length_of(edge_of(e, (k + 1) % 3)), length_of(edge_of(e, (k + 2) % 3))) <=
           length * rounded;
}

// What two emitters make whose edges i and j are the same, the other way round: the parallelogram
// whose sides are the means of their opposite edges, so that its area is the two emitters'.
Shape join(const Emitter& a, int i, const Emitter& b, int j) {
    const glm::dvec3 from(a.vertices[i]);
    const glm::dvec3 to(a.vertices[(i + 1) % 3]);
    const glm::dvec3 top(a.vertices[(i + 2) % 3]);
    const glm::dvec3 bottom(b.vertices[(j + 2) % 3]);
    Shape shape{LIGHT_QUAD, {}, (from - top + bottom - to) / 2.0, (to - top + bottom - from) / 2.0,
                0,          0};
    shape.corner = (from + to + top + bottom) / 4.0 - (shape.u + shape.v) / 2.0;
    // No point of the triangles is farther from it than their corners are from its corners.
    const double distance = glm::distance(shape.corner, top);
    shape.offset = std::max(a.offset, b.offset) + static_cast<float>(distance);
    return shape;
}

// Whether the joined corners are where those of `a` are, or as near as coordinates are rounded.
bool is_parallelogram(const Shape& joined, const Emitter& a, int i) {
    float largest = 0;
    for (const glm::vec3& p : a.vertices)
        for (int axis = 0; axis < 3; ++axis) largest = std::max(largest, std::abs(p[axis]));
    const double rounding = std::numeric_limits<float>::epsilon() * largest;
    const double side = std::min(glm::length(joined.u), glm::length(joined.v));
    const glm::dvec3 top(a.vertices[(i + 2) % 3]);
    return glm::distance(joined.corner, top) <= std::max(corner_tolerance * side, rounding);
}

// The emitters as triangles and parallelograms, in order. Where all neighbours make parallelograms,
// as in a regular grid, two across the longest edge of both come first: a rectangle's diagonal. Of
// many triangles at one edge, the last one is remembered.
std::vector<Shape> find_shapes(const std::vector<Emitter>& emitters) {
    constexpr LightKind gone = light_kind_count;  // into the other's parallelogram
    std::vector<Shape> shapes;
    for (std::size_t i = 0; i < emitters.size(); ++i) {
        const Emitter& e = emitters[i];
        shapes.push_back({LIGHT_TRIANGLE, e.vertices[0], e.edge1(), e.edge2(), e.offset, i});
    }
    for (const bool diagonals : {true, false}) {
        EdgeTable table(emitters);
        for (std::size_t i = 0; i < emitters.size(); ++i) {
            for (int k = 0; k < 3 && shapes[i].kind == LIGHT_TRIANGLE; ++k) {
                const Edge edge = edge_of(emitters[i], k);
                if (diagonals && !is_longest(emitters[i], k)) continue;
                const auto found = table.find({edge.to, edge.from, edge.material});
                if (!found) continue;
                const auto [other, j] = *found;
                if (shapes[other].kind != LIGHT_TRIANGLE) continue;
                Shape joined = join(emitters[other], j, emitters[i], k);
                if (!is_parallelogram(joined, emitters[other], j)) continue;
                joined.emitter = other;
                shapes[other] = joined;
                shapes[i].kind = gone;
            }
            for (int k = 0; k < 3 && shapes[i].kind == LIGHT_TRIANGLE; ++k)
                if (!diagonals || is_longest(emitters[i], k)) table.put({i, k});
        }
    }
    std::erase_if(shapes, [](const Shape& shape) { return shape.kind == gone; });
    return shapes;
}

}  // namespace

std::vector<Light> make_area_lights(const std::vector<Emitter>& emitters) {
    std::vector<Light> lights;
    for (const Shape& s : find_shapes(emitters)) {
        const Emitter& e = emitters[s.emitter];
        lights.push_back({float4(s.corner, s.kind), float4(s.u, e.both_sides ? 1 : 0),
                          float4(s.v, s.offset), float4(e.radiance, 0)});
    }
    return lights;
}

}  // namespace manylight
