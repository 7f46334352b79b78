// SPDX-License-Identifier: MIT
#include "scene/area_lights.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

namespace manylight {
namespace {

// Samplers give a light one weight for all its points, that of its centroid: a smaller cell's
// weight is a better estimate of its contribution. So an emitter is cut to cells, each a light,
// until no side is longer than cell_side, in m, or there are most_along_side of them along a side:
// lights cost memory and time, and seen from afar a large emitter's cells are small. Where all
// cells would still be more than most_cells, cell_side is doubled until they are not.
constexpr double cell_side = 0.25;
constexpr unsigned most_along_side = 64;
constexpr std::size_t most_cells = 1'000'000;

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
    std::size_t second;       // the other of a parallelogram's emitters
    bool varies = false;
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

std::uint32_t hash_of(const Edge& edge) {
    std::uint64_t hash = edge.material;
    for (const glm::vec3& p : {edge.from, edge.to})
        for (int axis = 0; axis < 3; ++axis) {
            const float x = p[axis] + 0.f;  // -0 is equal to 0
            hash = (hash ^ std::bit_cast<std::uint32_t>(x)) * 0x9e3779b97f4a7c15u;
            hash ^= hash >> 32;
        }
    return static_cast<std::uint32_t>(hash);
}

// Which edges may have their reverse among emitters: most of many lamps stand alone.
class SharedEdges {
  public:
    explicit SharedEdges(const std::vector<Emitter>& emitters) : shared_(3 * emitters.size()) {
        // Bits by hash: those that were met once, and again.
        const std::size_t bits = std::bit_ceil(std::max<std::size_t>(8 * shared_.size(), 64));
        std::vector<bool> met(bits), again(bits);
        const auto bit_of = [&](std::size_t i) {
            const Edge edge = edge_of(emitters[i / 3], static_cast<int>(i % 3));
            return (hash_of(edge) ^ hash_of({edge.to, edge.from, edge.material})) & (bits - 1);
        };
        for (std::size_t i = 0; i < shared_.size(); ++i) {
            const std::size_t bit = bit_of(i);
            if (met[bit]) again[bit] = true;
            met[bit] = true;
        }
        for (std::size_t i = 0; i < shared_.size(); ++i) {
            shared_[i] = again[bit_of(i)];
            count_ += shared_[i];
        }
    }
    [[nodiscard]] bool may_be(std::size_t emitter, int k) const { return shared_[3 * emitter + k]; }
    [[nodiscard]] std::size_t count() const { return count_; }

  private:
    std::vector<bool> shared_;  // [3 * emitter + k]
    std::size_t count_ = 0;
};

// Edges by where they are, by open addressing.
class EdgeTable {
  public:
    struct Side {
        std::size_t emitter;
        int k;
    };

    /// For up to `edges` of them.
    EdgeTable(const std::vector<Emitter>& emitters, std::size_t edges)
        : emitters_(emitters), slots_(std::bit_ceil(2 * edges + 1)) {}

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
    Shape shape{
        LIGHT_QUAD, {}, (from - top + bottom - to) / 2.0, (to - top + bottom - from) / 2.0, 0,
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
    shapes.reserve(emitters.size());
    for (std::size_t i = 0; i < emitters.size(); ++i) {
        const Emitter& e = emitters[i];
        shapes.push_back(
            {LIGHT_TRIANGLE, e.vertices[0], e.edge1(), e.edge2(), e.offset, i, i, e.varies});
    }
    const SharedEdges shared(emitters);
    for (const bool diagonals : {true, false}) {
        EdgeTable table(emitters, shared.count());
        for (std::size_t i = 0; i < emitters.size(); ++i) {
            for (int k = 0; k < 3 && shapes[i].kind == LIGHT_TRIANGLE; ++k) {
                if (!shared.may_be(i, k)) continue;
                const Edge edge = edge_of(emitters[i], k);
                if (diagonals && !is_longest(emitters[i], k)) continue;
                const auto found = table.find({edge.to, edge.from, edge.material});
                if (!found) continue;
                const auto [other, j] = *found;
                if (shapes[other].kind != LIGHT_TRIANGLE) continue;
                Shape joined = join(emitters[other], j, emitters[i], k);
                if (!is_parallelogram(joined, emitters[other], j)) continue;
                joined.emitter = other;
                joined.second = i;
                joined.varies = emitters[i].varies || emitters[other].varies;
                shapes[other] = joined;
                shapes[i].kind = gone;
            }
            for (int k = 0; k < 3 && shapes[i].kind == LIGHT_TRIANGLE; ++k)
                if (shared.may_be(i, k) && (!diagonals || is_longest(emitters[i], k)))
                    table.put({i, k});
        }
    }
    std::erase_if(shapes, [](const Shape& shape) { return shape.kind == gone; });
    return shapes;
}

// Into how many parts a length is cut that are no longer than `side`, unless they are too many.
unsigned parts_of(double length, double side) {
    const double parts = std::ceil(length / (side * rounded));
    return static_cast<unsigned>(std::clamp<double>(parts, 1, most_along_side));
}

// The numbers of cells along u and v; there are as many as their product. A triangle is cut to four
// and these again, until the longest edge is short enough.
glm::uvec2 cells_along(const Shape& s, double side) {
    if (s.varies) side /= varied_cells;
    if (s.kind == LIGHT_QUAD)
        return {parts_of(glm::length(s.u), side), parts_of(glm::length(s.v), side)};
    const double longest = std::max({glm::length(s.u), glm::length(s.v), glm::length(s.u - s.v)});
    return glm::uvec2(std::bit_ceil(parts_of(longest, side)));
}

// A side of cells for which there are at most most_cells; or one per shape, if those are more.
double choose_side(const std::vector<Shape>& shapes) {
    const auto count = [&shapes](double side) {
        std::size_t cells = 0;
        for (const Shape& s : shapes) {
            const glm::uvec2 n = cells_along(s, side);
            cells += std::size_t{n.x} * n.y;
        }
        return cells;
    };
    double side = cell_side;
    while (count(side) > std::max(most_cells, shapes.size())) side *= 2;
    return side;
}

// A vector as a sum of parts of two.
glm::dvec2 parts_along(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& v) {
    const glm::dmat2 gram(glm::dot(a, a), glm::dot(a, b), glm::dot(a, b), glm::dot(b, b));
    return glm::inverse(gram) * glm::dvec2(glm::dot(a, v), glm::dot(b, v));
}

// A point of an emitter's plane, or a vector in it, by its weights of vertices 1 and 2.
glm::dvec2 weights_of(const Emitter& e, const glm::dvec3& v) {
    return parts_along(glm::dvec3(e.edge1()), glm::dvec3(e.edge2()), v);
}

// Where in or, below 0, how far out of the emitter a point of its plane is.
double inside(const Emitter& e, const glm::dvec3& p) {
    const glm::dvec2 w = weights_of(e, p - glm::dvec3(e.vertices[0]));
    return std::min({w.x, w.y, 1 - w.x - w.y});
}

// The radiance of a cell of a shape's emitters, over which it varies.
glm::vec3 radiance_of(const Light& cell, const Emitter& first, const Emitter& second,
                      const RadianceOfPart& radiance_of_part) {
    const bool triangle = static_cast<LightKind>(cell.position.w) == LIGHT_TRIANGLE;
    const glm::dvec3 corner(glm::vec3(cell.position));
    const glm::dvec3 u(glm::vec3(cell.axis));
    const glm::dvec3 v(glm::vec3(cell.edge));
    const glm::dvec3 centre = corner + (u + v) / (triangle ? 3.0 : 2.0);
    const Emitter& e = inside(first, centre) >= inside(second, centre) ? first : second;
    return radiance_of_part(e, weights_of(e, corner - glm::dvec3(e.vertices[0])), weights_of(e, u),
                            weights_of(e, v), triangle);
}

// Of one of the emitters of a shape that is cut to n.x by n.y cells, the next of the table.
CellGrid grid_of(const Emitter& e, const Shape& s, const glm::uvec2& n, std::size_t first) {
    const glm::dvec2 size(n);
    const glm::dvec2 at = size * parts_along(s.u, s.v, glm::dvec3(e.vertices[0]) - s.corner);
    const glm::dvec2 edge1 = size * parts_along(s.u, s.v, glm::dvec3(e.edge1()));
    const glm::dvec2 edge2 = size * parts_along(s.u, s.v, glm::dvec3(e.edge2()));
    const double area = glm::length(glm::cross(s.u / size.x, s.v / size.y));
    return {float4(at.x, edge1.x, edge2.x, s.kind),
            float4(at.y, edge1.y, edge2.y, 0),
            static_cast<float>(area / (s.kind == LIGHT_TRIANGLE ? 2 : 1)),
            static_cast<std::uint32_t>(first),
            n.x,
            n.y};
}

void add_cells(AreaLights& out, const Shape& s, const std::vector<Emitter>& emitters, double side,
               const RadianceOfPart& radiance_of_part) {
    const Emitter& e = emitters[s.emitter];
    const glm::uvec2 n = cells_along(s, side);
    const glm::dvec3 u = s.u / static_cast<double>(n.x);
    const glm::dvec3 v = s.v / static_cast<double>(n.y);
    const auto add = [&](const glm::dvec3& corner, double sign) {
        Light cell{float4(corner, s.kind), float4(sign * u, e.both_sides ? 1 : 0),
                   float4(sign * v, s.offset), float4(e.radiance, 0)};
        if (s.varies)
            cell.emission = float4(radiance_of(cell, e, emitters[s.second], radiance_of_part), 0);
        const bool dark = cell.emission == float4(0);
        out.cell_lights.push_back(dark ? NO_LIGHT : static_cast<std::uint32_t>(out.lights.size()));
        if (!dark) out.lights.push_back(cell);
    };
    const bool triangle = s.kind == LIGHT_TRIANGLE;
    for (const std::size_t i : {s.emitter, s.second})
        out.grids[i] = grid_of(emitters[i], s, n, out.cell_lights.size());
    for (unsigned j = 0; j < n.y; ++j)
        for (unsigned i = 0; i < (triangle ? n.x - j : n.x); ++i) {
            const glm::dvec3 corner =
                s.corner + static_cast<double>(i) * u + static_cast<double>(j) * v;
            add(corner, 1);
            // The other half of the parallelogram of u and v, turned by 180 degrees.
            if (triangle && i + j + 1 < n.x) add(corner + u + v, -1);
        }
}

}  // namespace

AreaLights make_area_lights(const std::vector<Emitter>& emitters,
                            const RadianceOfPart& radiance_of_part) {
    const std::vector<Shape> shapes = find_shapes(emitters);
    const double side = choose_side(shapes);
    AreaLights out;
    out.grids.resize(emitters.size());
    for (const Shape& s : shapes) add_cells(out, s, emitters, side, radiance_of_part);
    return out;
}

}  // namespace manylight
