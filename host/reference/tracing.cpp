// SPDX-License-Identifier: MIT
#include "reference/tracing.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

#include "reference/random.hpp"
#include "reference/textures.hpp"
#include "reference/triangle.hpp"

namespace manylight::reference {
namespace {

constexpr double epsilon = std::numeric_limits<float>::epsilon();

// Where the segment is inside a box, by slabs; boxes are closed.
bool meets_box(const Ray& ray, const glm::dvec3& lower, const glm::dvec3& upper, double end) {
    double enter = 0;
    double leave = end;
    for (int axis = 0; axis < 3; ++axis) {
        if (ray.direction[axis] == 0) {
            if (ray.origin[axis] < lower[axis] || ray.origin[axis] > upper[axis]) return false;
            continue;
        }
        double a = (lower[axis] - ray.origin[axis]) / ray.direction[axis];
        double b = (upper[axis] - ray.origin[axis]) / ray.direction[axis];
        if (a > b) std::swap(a, b);
        const double slack = 1e-12 * (std::abs(a) + std::abs(b));
        enter = std::max(enter, a - slack);
        leave = std::min(leave, b + slack);
    }
    return enter <= leave;
}

}  // namespace

Tracer::Tracer(const Scene& scene) : scene_(scene), order_(scene.own_triangle_count()) {
    std::iota(order_.begin(), order_.end(), 0u);
    for (const Instance& in : scene.instances)
        for (uint k = 0; k < scene.shared_meshes[in.mesh].triangle_count; ++k)
            order_.push_back(in.first + k);
    if (!order_.empty()) root_ = build(0, static_cast<uint>(order_.size()));
}

int Tracer::build(uint begin, uint end) {
    Node node{glm::dvec3(1e300), glm::dvec3(-1e300), begin, end, 1};
    for (uint i = begin; i < end; ++i) {
        const Triangle triangle(scene_, order_[i]);
        double longest = 0;
        for (int k = 0; k < 3; ++k) {
            const glm::dvec3 corner = triangle.corner(k);
            node.lower = glm::min(node.lower, corner);
            node.upper = glm::max(node.upper, corner);
            longest = std::max(longest, glm::distance(corner, triangle.corner((k + 1) % 3)));
        }
        const double area = glm::length(triangle.face());
        if (area > 0) node.stretch = std::max(node.stretch, longest * longest / area);
    }
    if (end - begin > 4) {
        const glm::dvec3 size = node.upper - node.lower;
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const uint middle = begin + (end - begin) / 2;
        const auto centre = [&](uint t) {
            const Triangle triangle(scene_, t);
            return triangle.corner(0)[axis] + triangle.corner(1)[axis] + triangle.corner(2)[axis];
        };
        std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                         [&](uint a, uint b) { return centre(a) < centre(b); });
        node.left = build(begin, middle);
        node.right = build(middle, end);
    }
    nodes_.push_back(node);
    return static_cast<int>(nodes_.size()) - 1;
}

// Moeller and Trumbore (1997).
void Tracer::test(uint triangle, const Ray& ray, std::optional<Hit>& best) const {
    const Triangle tested(scene_, triangle);
    const glm::dvec3 v0 = tested.corner(0);
    const glm::dvec3 e1 = tested.corner(1) - v0;
    const glm::dvec3 e2 = tested.corner(2) - v0;
    const glm::dvec3 p = glm::cross(ray.direction, e2);
    const double determinant = glm::dot(e1, p);
    if (determinant == 0) return;
    const glm::dvec3 s = ray.origin - v0;
    const double u = glm::dot(s, p) / determinant;
    if (u < 0 || u > 1) return;
    const glm::dvec3 q = glm::cross(s, e1);
    const double v = glm::dot(ray.direction, q) / determinant;
    if (v < 0 || u + v > 1) return;
    const double t = glm::dot(e2, q) / determinant;
    const Hit hit{triangle, t, u, v};
    if (t > ray.start && t < (best ? best->t : ray.end) && is_there(ray, hit)) best = hit;
}

// What is partly there is so by chance, but for one ray always alike.
bool Tracer::is_there(const Ray& ray, const Hit& hit) const {
    const Triangle triangle(scene_, hit.triangle);
    const Material& material = scene_.materials[triangle.material()];
    if (material.culled != 0 && glm::dot(triangle.face(), ray.direction) > 0) return false;
    const float cutoff = material.cutoff;
    if (cutoff == 0) return true;
    const double alpha = alpha_at(scene_, hit);
    if (cutoff > 0) return alpha >= cutoff;
    std::array<uint, 4> bits = {hit.triangle, 0, 0, 0};
    for (const double part : {ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x,
                              ray.direction.y, ray.direction.z})
        bits =
            random_bits(bits[0], std::bit_cast<uint>(static_cast<float>(part)), bits[2], bits[3]);
    return unit_fraction(bits[0]) < alpha;
}

std::optional<Hit> Tracer::closest_hit(const Ray& ray) const {
    std::optional<Hit> best;
    std::vector<int> open;
    if (root_ >= 0) open.push_back(root_);
    while (!open.empty()) {
        const Node& node = nodes_[open.back()];
        open.pop_back();
        if (!meets_box(ray, node.lower, node.upper, best ? best->t : ray.end)) continue;
        if (node.left >= 0) {
            open.push_back(node.right);
            open.push_back(node.left);
            continue;
        }
        for (uint i = node.begin; i < node.end; ++i) test(order_[i], ray, best);
    }
    return best;
}

std::optional<Hit> Tracer::closest_hit_of_all(const Ray& ray) const {
    std::optional<Hit> best;
    for (const uint triangle : order_) test(triangle, ray, best);
    return best;
}

std::optional<Hit> Tracer::hit_of(uint triangle, const Ray& ray) const {
    std::optional<Hit> hit;
    test(triangle, ray, hit);
    return hit;
}

// In the frame in which kernels meet it: its mesh's.
std::optional<Tracer::RoundedHit> Tracer::meet_plane(uint triangle, const Ray& ray) const {
    const Triangle tested(scene_, triangle);
    const glm::dvec3 from_place = ray.origin - tested.place();
    const glm::dmat3 to_mesh = tested.to_mesh();
    const glm::dvec3 d = to_mesh * ray.direction;
    const glm::dvec3 v0 = tested.stored_corner(0);
    const glm::dvec3 e1 = tested.stored_corner(1) - v0;
    const glm::dvec3 e2 = tested.stored_corner(2) - v0;
    const glm::dvec3 n = glm::cross(e1, e2);
    const glm::dvec3 s = to_mesh * from_place - v0;
    const double determinant = -glm::dot(n, d);
    if (determinant == 0) return {};
    const double size = std::abs(determinant);
    const glm::dvec3 q = glm::cross(s, d) / determinant;
    const double t = glm::dot(n, s) / determinant;
    const double far = std::max({glm::length(s), glm::length(s - e1), glm::length(s - e2)});
    const double edge = std::max({glm::length(e1), glm::length(e2), glm::length(e2 - e1)});
    // Twice the kernels' margin (kernels/lib/block.h), whose test is rounded.
    RoundedHit met{{triangle, t, glm::dot(e2, q), -glm::dot(e1, q)},
                   2e-6 * far * edge * glm::length(d) / size,
                   0,
                   0,
                   0};
    // What cancels in the normal, a cross product. Kernels take no more than 3 times that for it,
    // and pass over 4 units in the last place; what they compute is off by as much at most.
    const glm::dvec3 f = glm::abs(e1);
    const glm::dvec3 g = glm::abs(e2);
    const glm::dvec3 m(f.y * g.z + f.z * g.y, f.z * g.x + f.x * g.z, f.x * g.y + f.y * g.x);
    const double most = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    met.start = 17 * epsilon * glm::dot(glm::abs(s), m) / size;
    met.before_end = 17 * epsilon * most * (m.x + m.y + m.z) / size;
    if (!tested.is_of_instance()) return met;
    // The ray in the mesh's frame: a difference, a matrix and sums of three products, rounded.
    const auto moved_by = [&](const glm::dvec3& v) {
        glm::dvec3 sizes(0);
        for (int k = 0; k < 3; ++k) sizes += glm::abs(to_mesh[k]) * std::abs(v[k]);
        return 4 * epsilon * sizes;
    };
    const glm::dvec3 origin = moved_by(from_place);
    const glm::dvec3 direction = moved_by(ray.direction);
    met.moved = glm::dot(glm::abs(n), origin + std::abs(t) * direction) / size;
    met.start += met.moved;
    met.beyond += glm::length(origin + std::abs(t) * direction) * edge * glm::length(d) / size;
    return met;
}

std::optional<Hit> Tracer::hit_near(uint triangle, const Ray& ray) const {
    const auto met = meet_plane(triangle, ray);
    if (!met || met->hit.t <= ray.start || met->hit.t >= ray.end || met->inside() < -met->beyond)
        return {};
    return is_there(ray, met->hit) ? std::optional(met->hit) : std::nullopt;
}

bool Tracer::rounding_decides(const Ray& ray) const {
    bool maybe = false;
    std::vector<int> open;
    if (root_ >= 0) open.push_back(root_);
    Ray line = ray;  // a length farther at both ends
    line.origin -= ray.direction;
    while (!open.empty()) {
        const Node& node = nodes_[open.back()];
        open.pop_back();
        const glm::dvec3 reach =
            glm::max(glm::abs(node.lower - ray.origin), glm::abs(node.upper - ray.origin));
        // Kernels hit a triangle as far beyond each edge's line, and so beyond a sliver's end.
        const glm::dvec3 pad(4e-6 * glm::length(reach) * node.stretch);
        if (!meets_box(line, node.lower - pad, node.upper + pad, ray.end + 2)) continue;
        if (node.left >= 0) {
            open.push_back(node.right);
            open.push_back(node.left);
            continue;
        }
        for (uint i = node.begin; i < node.end; ++i) {
            const auto met = meet_plane(order_[i], ray);
            if (!met || !met->may_occlude(ray.end) || !is_there(ray, met->hit)) continue;
            maybe = true;
            if (met->surely_occludes(ray.end)) return false;
        }
    }
    return maybe;
}

std::vector<Ray> Tracer::neighbours(const Ray& ray, EndShifts shifts) {
    std::vector<Ray> rays;
    const bool infinite = std::isinf(ray.end);
    for (const double size : {1.0, 0.5, 0.25, 0.125, 0.0625})
        for (int k = 0; k < 64; ++k) {
            const auto corner_of = [&](int bits, const glm::dvec3& shift) {
                return glm::dvec3(bits & 1 ? 1 : -1, bits & 2 ? 1 : -1, bits & 4 ? 1 : -1) * size *
                       shift;
            };
            Ray moved = ray;
            const glm::dvec3 step = corner_of(k, shifts.origin);
            moved.origin += step;
            moved.direction += corner_of(k >> 3, shifts.end) - (infinite ? glm::dvec3(0) : step);
            rays.push_back(moved);
        }
    return rays;
}

bool Tracer::occlusion_is_borderline(const Ray& ray, EndShifts shifts) const {
    if (rounding_decides(ray)) return true;
    const bool expected = occluded(ray);
    for (const Ray& moved : neighbours(ray, shifts))
        if (occluded(moved) != expected) return true;
    return false;
}

}  // namespace manylight::reference
