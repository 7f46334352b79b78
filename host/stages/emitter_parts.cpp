// SPDX-License-Identifier: MIT
#include "stages/emitter_parts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

namespace manylight {
namespace {

// Of a pixel, that its own rays see well enough.
constexpr double nearly_all = 0.999;

// A point of a triangle on the film: x / z and y / z are pixels from the top left corner; `depth`
// is along the view, m.
struct Corner {
    double x, y, z, depth;
    glm::dvec2 weights;  // of the triangle's vertices 1 and 2
};

Corner mix(const Corner& a, const Corner& b, double t) {
    const auto between = [t](const auto& from, const auto& to) { return from + (to - from) * t; };
    return {between(a.x, b.x), between(a.y, b.y), between(a.z, b.z), between(a.depth, b.depth),
            between(a.weights, b.weights)};
}

// Convex: each of the planes that a triangle is cut by adds a corner at most, and there are two
// across the view, four about the image and four about a pixel.
class Polygon {
  public:
    Polygon() = default;
    Polygon(std::initializer_list<Corner> corners) {
        for (const Corner& c : corners) push_back(c);
    }
    void push_back(const Corner& corner) { corners_[size_++] = corner; }
    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] const Corner& operator[](std::size_t i) const { return corners_[i]; }
    [[nodiscard]] const Corner* begin() const { return corners_.data(); }
    [[nodiscard]] const Corner* end() const { return begin() + size_; }

  private:
    std::array<Corner, 3 + 10> corners_;
    std::size_t size_ = 0;
};

// What of a polygon lies where `height`, which is linear, is above 0 (Sutherland and Hodgman,
// "Reentrant Polygon Clipping", 1974).
template <class Height>
Polygon clip(const Polygon& polygon, const Height& height) {
    const auto is_in = [&height](const Corner& c) { return height(c) > 0; };
    if (std::ranges::all_of(polygon, is_in)) return polygon;
    Polygon out;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Corner& a = polygon[i];
        const Corner& b = polygon[(i + 1) % polygon.size()];
        const double ha = height(a), hb = height(b);
        if (ha > 0) out.push_back(a);
        if ((ha > 0) != (hb > 0)) out.push_back(mix(a, b, ha / (ha - hb)));
    }
    return out;
}

// Between two columns, or rows, of the film.
template <double Corner::*axis>
Polygon clip_between(const Polygon& polygon, double from, double to) {
    return clip(clip(polygon, [from](const Corner& c) { return c.*axis - from * c.z; }),
                [to](const Corner& c) { return to * c.z - c.*axis; });
}

// In pixels.
double area_of(const Polygon& polygon) {
    if (polygon.size() < 3) return 0;
    const auto place = [](const Corner& c) { return glm::dvec2(c.x, c.y) / c.z; };
    const glm::dvec2 from = place(polygon[0]);
    double twice = 0;
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
        const glm::dvec2 a = place(polygon[i]) - from;
        const glm::dvec2 b = place(polygon[i + 1]) - from;
        twice += a.x * b.y - a.y * b.x;
    }
    return std::abs(twice) / 2;
}

// The pixels along an axis that a polygon reaches into.
template <double Corner::*axis>
std::pair<uint, uint> reach_of(const Polygon& polygon, uint pixels) {
    double least = pixels, most = 0;
    for (const Corner& c : polygon) {
        least = std::min(least, c.*axis / c.z);
        most = std::max(most, c.*axis / c.z);
    }
    return {static_cast<uint>(std::max(std::floor(least), 0.0)),
            static_cast<uint>(std::min(std::ceil(most), double(pixels)))};
}

// A camera's film in double precision.
class Film {
  public:
    Film(const Camera& camera, unsigned width, unsigned height)
        : width_(width),
          height_(height),
          origin_(camera.origin),
          right_(camera.right),
          up_(camera.up),
          forward_(camera.forward),
          orthographic_(camera.forward.w != 0),
          near_(camera.right.w),
          far_(camera.up.w),
          normal_(glm::normalize(glm::cross(right_, up_))) {
        normal_ /= glm::dot(normal_, forward_);
    }

    // Whether the camera is on the side that a triangle's winding faces.
    [[nodiscard]] bool is_before(const glm::dvec3& corner, const glm::dvec3& face) const {
        return glm::dot(face, orthographic_ ? forward_ : corner - origin_) < 0;
    }

    // What of a triangle the camera sees.
    [[nodiscard]] Polygon project(const glm::dvec3 (&corners)[3]) const {
        const glm::dvec2 weights[3] = {{0, 0}, {1, 0}, {0, 1}};
        Polygon polygon;
        for (int k = 0; k < 3; ++k) polygon.push_back(corner(corners[k], weights[k]));
        polygon = clip(polygon, [this](const Corner& c) { return c.depth - near_; });
        if (far_ > 0) polygon = clip(polygon, [this](const Corner& c) { return far_ - c.depth; });
        polygon = clip_between<&Corner::x>(polygon, 0, width_);
        return clip_between<&Corner::y>(polygon, 0, height_);
    }

  private:
    [[nodiscard]] Corner corner(const glm::dvec3& point, const glm::dvec2& weights) const {
        const glm::dvec3 from = point - origin_;
        const double depth = glm::dot(normal_, from);
        const double z = orthographic_ ? 1 : depth;
        const glm::dvec3 offset = from - depth * forward_;
        const double x = glm::dot(offset, right_) / glm::dot(right_, right_);
        const double y = glm::dot(offset, up_) / glm::dot(up_, up_);
        return {(z + x) / 2 * width_, (z - y) / 2 * height_, z, depth, weights};
    }

    double width_, height_;
    glm::dvec3 origin_, right_, up_, forward_;
    bool orthographic_;
    double near_, far_;
    glm::dvec3 normal_;  // of the image plane; forward is 1 along it
};

struct Found {
    EmitterPart part;
    float covered;  // of the pixel by the triangle
};

EmitterPart part_of(const Polygon& corners, uint triangle, uint pixel) {
    const auto& [a, b, c] = std::tie(corners[0], corners[1], corners[2]);
    const glm::vec2 way_1 = b.weights - a.weights;
    const glm::vec2 way_2 = c.weights - a.weights;
    return {float4(glm::vec2(a.weights), way_1),
            float4(way_2, glm::vec2(a.z / b.z, a.z / c.z)),
            static_cast<float>(area_of(corners)),
            triangle,
            pixel,
            0};
}

// Cuts what is seen of a triangle by pixels.
void cut(const Polygon& seen, uint triangle, unsigned width, unsigned height,
         std::vector<Found>& found) {
    if (seen.size() < 3) return;
    const auto [top, bottom] = reach_of<&Corner::y>(seen, height);
    for (uint y = top; y < bottom; ++y) {
        const Polygon row = clip_between<&Corner::y>(seen, y, y + 1);
        if (row.size() < 3) continue;
        const auto [left, right] = reach_of<&Corner::x>(row, width);
        for (uint x = left; x < right; ++x) {
            const Polygon part = clip_between<&Corner::x>(row, x, x + 1);
            const double covered = area_of(part);
            if (!(covered > 0) || covered > nearly_all) continue;
            for (std::size_t i = 1; i + 1 < part.size(); ++i)
                found.push_back({part_of({part[0], part[i], part[i + 1]}, triangle, y * width + x),
                                 static_cast<float>(covered)});
        }
    }
}

bool is_drawn(const Scene& scene, uint triangle) {
    const Material& m = scene.materials[scene.triangle_materials[triangle]];
    const bool whole = scene.alpha_of.empty() || scene.alpha_of[triangle] == NO_ALPHA;
    return glm::vec3(m.emission) != glm::vec3(0) && m.unlit == 0 && whole;
}

}  // namespace

std::size_t EmitterParts::bytes() const {
    if (empty()) return 0;
    return parts.size() * sizeof(EmitterPart) + pixel_parts.size() * sizeof(uint) +
           drawn() * sizeof(float4);
}

EmitterParts find_emitter_parts(const Scene& scene, const Camera& camera, unsigned width,
                                unsigned height) {
    const Film film(camera, width, height);
    std::vector<Found> found;
    for (uint t = 0; t < scene.own_triangle_count(); ++t) {
        if (!is_drawn(scene, t)) continue;
        glm::dvec3 v[3];
        for (uint k = 0; k < 3; ++k)
            v[k] = glm::dvec3(scene.vertices[scene.indices[3 * std::size_t{t} + k]]);
        const glm::dvec3 face = glm::cross(v[1] - v[0], v[2] - v[0]);
        const bool both_sides = scene.materials[scene.triangle_materials[t]].emission.w != 0;
        if (both_sides || film.is_before(v[0], face)) cut(film.project(v), t, width, height, found);
    }
    EmitterParts out;
    const std::size_t pixels = std::size_t{width} * height;
    out.stride = static_cast<uint>(std::max<std::size_t>((found.size() + pixels - 1) / pixels, 1));
    if (out.stride > 1)
        std::erase_if(found, [&](const Found& f) { return f.covered * float(out.stride) > 1; });
    out.pixel_parts.resize(pixels + 1);
    for (const Found& f : found) ++out.pixel_parts[f.part.pixel + 1];
    for (std::size_t p = 0; p < pixels; ++p) out.pixel_parts[p + 1] += out.pixel_parts[p];
    out.parts.resize(found.size());
    std::vector<uint> next(out.pixel_parts.begin(), out.pixel_parts.end() - 1);
    for (const Found& f : found) out.parts[next[f.part.pixel]++] = f.part;
    return out;
}

EmitterPartStage::EmitterPartStage(Device& device, const DeviceScene& scene,
                                   const EmitterParts& found)
    : scene_(scene.arguments),
      stride_(found.stride),
      draw_(
          device.kernel("emitter_parts.cl", "emitter_parts_draw", scene.surfaces, "emitter_parts")),
      gather_(device.kernel("emitter_parts.cl", "emitter_parts_gather", scene.surfaces,
                            "emitter_parts")),
      light_(device.allocate<float4>(found.drawn())) {
    scene_.set("parts", device.upload(found.parts))
        .set("part_count", static_cast<uint>(found.parts.size()))
        .set("pixel_parts", device.upload(found.pixel_parts))
        .set("stride", stride_)
        .set("light", light_);
}

void EmitterPartStage::trace(const Tiles& tiles, const PixelSample& sample,
                             const Buffer<Surface>& surfaces, Buffer<float4>& seen) {
    // From a random number on, so that each is as likely in any sample.
    first_ = (sample.index + sample.seed * 0x9e3779b9u) % stride_;
    Arguments arguments(scene_);
    arguments.set("tiles", tiles)
        .set("first", first_)
        .set("pixel_sample", sample.index)
        .set("seed", sample.seed)
        .set("alpha_salt", sample.salt())
        .set("surfaces", surfaces)
        .set("seen", seen);
    draw_.launch(light_.size(), arguments);
    gather_.launch(item_count(tiles), arguments);
}

}  // namespace manylight
