// SPDX-License-Identifier: MIT
// What a scene file means: triangles, materials, lights and cameras in world space (right-handed,
// y up, metres, glTF's photometric units), about Scene::origin. Knows no OpenCL.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "shared/camera.h"
#include "shared/instance.h"
#include "shared/light.h"
#include "shared/light_cells.h"
#include "shared/material.h"
#include "shared/texture.h"

namespace manylight {

/// A camera as the file describes it, or as the scene was framed.
struct View {
    std::string name;          // the node's, or else the camera's, or else its number
    std::string camera_name;   // the camera's own
    glm::dmat4 to_world{1.0};  // rigid, or mirrored; looks along its -z
    bool orthographic = false;
    double aspect = 0;       // width / height; 0 where the file leaves it to the image
    double half_height = 0;  // of the image: m if orthographic, otherwise tan(yfov / 2)
    double near = 0;         // nothing nearer is seen, m along the view
    double far = 0;          // nor anything farther; 0: all is
};

struct Bounds {
    glm::vec3 lower{std::numeric_limits<float>::infinity()};
    glm::vec3 upper{-std::numeric_limits<float>::infinity()};
    void add(glm::vec3 p) {
        lower = glm::min(lower, p);
        upper = glm::max(upper, p);
    }
    [[nodiscard]] bool empty() const { return lower.x > upper.x; }
    [[nodiscard]] glm::vec3 centre() const {
        return empty() ? glm::vec3(0) : (lower + upper) / 2.f;
    }
    [[nodiscard]] float radius() const { return empty() ? 0 : glm::length(upper - lower) / 2; }
    /// 0 to 7.
    [[nodiscard]] glm::vec3 corner(int k) const {
        return {k & 1 ? upper.x : lower.x, k & 2 ? upper.y : lower.y, k & 4 ? upper.z : lower.z};
    }
};

/// From the frame of an instance's mesh to the world.
[[nodiscard]] inline glm::vec3 point_to_world(const Instance& in, const glm::vec3& p) {
    const float4 v(p, 1);
    return {glm::dot(in.to_world[0], v), glm::dot(in.to_world[1], v), glm::dot(in.to_world[2], v)};
}

/// The place that a matrix says; `first`, `stored` and `mesh` are unset.
[[nodiscard]] Instance make_instance(const glm::dmat4& to_world);

/// A mesh that is stored once and stands where instances say, in a frame of its own. It gives no
/// light.
struct SharedMesh {
    std::uint32_t first_triangle, triangle_count;  // its run of the scene's
    std::uint32_t first_vertex, vertex_count;      // likewise
    Bounds bounds;
};

/// The cells that the area lights of a scene's triangles are cut to, each a light or without light.
struct LightCells {
    std::vector<std::uint32_t> grid_of;  // [triangle] into grids, or NO_GRID
    std::vector<CellGrid> grids;
    std::vector<std::uint32_t> lights;  // [CellGrid::first + cell] the scene's, or NO_LIGHT

    /// There are no area lights.
    [[nodiscard]] bool empty() const { return grids.empty(); }
};

struct Scene {
    std::string file;                // as the user named it
    std::vector<std::string> files;  // beside it, that it names
    // Where positions are counted from, in the file's frame, m: 0, or near the middle of a scene
    // that lies far from the file's own origin (see find_origin()).
    glm::dvec3 origin{0};
    std::vector<glm::vec3> vertices;        // finite
    std::vector<glm::vec3> vertex_normals;  // per vertex, unit or 0 where flat; empty if all
    std::vector<std::uint32_t> indices;     // [3 * triangle + corner] into vertices
    std::vector<std::uint32_t> triangle_materials;  // [triangle] into materials
    // Theirs are the last vertices and triangles, in this order; all others stand in the world.
    std::vector<SharedMesh> shared_meshes;
    std::vector<Instance> instances;  // of these
    std::vector<Material> materials;
    std::vector<std::string> material_names;  // [material], as in the file; may be empty
    std::vector<TextureMap> maps;   // [MAP_KIND_COUNT * material + MapKind]; empty if all are none
    std::vector<Texture> textures;  // what maps name
    std::vector<std::uint32_t> texels;                // of all textures, see shared/texture.h
    std::vector<std::vector<glm::vec2>> coordinates;  // [set][vertex] on textures
    // [vertex], linear RGBA, 0 to 1, times the material's; may be empty
    std::vector<float4> colors;
    // [vertex], xyz: unit, w: 1 or -1 as in glTF; 0 where texture coordinates are to say; empty if
    // all are
    std::vector<float4> tangents;
    // Of the triangles of which not all is there, and [triangle] which of these, or NO_ALPHA; both
    // empty if there are none.
    std::vector<AlphaTriangle> alpha_triangles;
    std::vector<std::uint32_t> alpha_of;
    std::vector<Light> lights;
    std::vector<std::string> light_names;  // likewise, of the file's own lights, which come first
    LightCells light_cells;
    std::vector<View> views;
    std::vector<std::string> warnings;       // what the file holds and is not rendered
    std::optional<unsigned> emitter_points;  // the file's own wish, see load_scene()

    /// As many as are stored.
    [[nodiscard]] std::size_t triangle_count() const { return triangle_materials.size(); }
    /// Of these, the ones that stand in the world.
    [[nodiscard]] std::size_t own_triangle_count() const {
        return shared_meshes.empty() ? triangle_count() : shared_meshes.front().first_triangle;
    }
    /// As many as are seen: instances counted one by one.
    [[nodiscard]] std::size_t seen_triangle_count() const;
    /// Of all that is seen.
    [[nodiscard]] Bounds bounds() const;
    /// A position in the file's frame, m.
    [[nodiscard]] glm::dvec3 in_file(const glm::vec3& p) const { return origin + glm::dvec3(p); }
    /// Whether a surface point's material is its own: its textures and vertex colours say more than
    /// its triangle's does.
    [[nodiscard]] bool varies_materials() const { return !maps.empty() || !colors.empty(); }
};

/// Which kernel code a scene needs.
struct Features {
    bool ggx = false;            // a material is more than Lambert's
    bool smooth = false;         // a mesh has vertex normals
    bool emission = false;       // emitters can be seen
    bool reflections = false;    // glossy materials reflect area lights
    bool textures = false;       // materials have textures
    bool specular_maps = false;  // ... of their specular factor and colour
    bool colors = false;         // vertices have colours
    bool tangents = false;       // vertices have tangents
    bool alpha = false;          // not all of every triangle is there
    bool instances = false;      // meshes are stored once and stand in several places
};

[[nodiscard]] Features find_features(const Scene& scene);

/// Whether a material takes something from a texture.
[[nodiscard]] bool has_map(const Scene& scene, std::size_t material, MapKind kind);

/// Luminance, linear Rec. 709.
[[nodiscard]] inline float luminance(glm::vec3 rgb) {
    return 0.2126f * rgb.r + 0.7152f * rgb.g + 0.0722f * rgb.b;
}

/// A spot's edge.x and edge.y (shared/light.h) by the angles of KHR_lights_punctual, radians. Where
/// both are the same, its edge is sharp.
[[nodiscard]] glm::vec2 spot_cone(double inner, double outer);

/// Adds the lights of a scene's emissive triangles and sets the power of every light. `points` 0:
/// area lights (see make_area_lights()), and their cells' areas. Otherwise that many oriented
/// points of equal power, spread over all emissive triangles by power (paper section 5); their
/// total power, as luminance, is the triangles'. Triangles without area emit nothing. Where not all
/// of an emitter is there (Material::cutoff), it emits as much as there is of it.
void add_emitters(Scene& scene, unsigned points);

/// Where a scene's positions are to be counted from, given its bounds in the file's frame: so that
/// single precision tells its shapes wherever it lies. The file's origin, unless the bounds lie
/// farther from that, along an axis, than 16 times their longest side, where 4 of 24 bits would be
/// lost; then their centre, rounded to a multiple of a power of 2 no less than that side: a scene
/// that is moved by such a multiple has the very same positions as before.
[[nodiscard]] glm::dvec3 find_origin(const Bounds& bounds);
/// Whether nothing of a scene shows: no light is left after add_emitters(), and nothing is unlit.
[[nodiscard]] bool is_dark(const Scene& scene);

/// Adds a light of the camera's own to a scene that has its other lights, last of the file's: a
/// perspective camera's is a point in the middle of its near plane, an orthographic one's shines
/// along its view, from that plane on. A white surface that faces the camera has about 1 cd/m2,
/// where the camera is a point as far from it as from the scene's middle, or as far as the scene's
/// radius.
void add_headlight(Scene& scene, const View& view);

/// The camera of that name, or the first for an empty name; a scene without cameras is framed from
/// the front, above and right, so that its triangles fill 85% of the width or of the height of an
/// image of that width / height. Throws InputError for a name that the file does not have.
[[nodiscard]] View find_view(const Scene& scene, const std::string& name, double aspect = 16.0 / 9);

/// The camera for an image of that size; keeps the view's height where the aspect differs. `shift`
/// by pixels, to the right and down, shows what lies there, as a shifted lens does.
[[nodiscard]] Camera make_camera(const View& view, unsigned width, unsigned height,
                                 std::pair<double, double> shift = {0, 0});

}  // namespace manylight
