// SPDX-License-Identifier: MIT
#define GLM_ENABLE_EXPERIMENTAL
#include "scene/gltf/meshes.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtx/component_wise.hpp>
#include <span>

#include "error.hpp"
#include "scene/gltf/model.hpp"

namespace manylight {
namespace {

// 0 where there is no direction.
glm::dvec3 unit(const glm::dvec3& v) {
    const double length = glm::length(v);
    return std::isfinite(length) && length > 0 ? v / length : glm::dvec3(0);
}

}  // namespace

MeshReader::MeshReader(Loading& in, std::vector<unsigned> coordinate_sets, double expected)
    : in_(in),
      scene_(in.scene),
      coordinate_sets_(std::move(coordinate_sets)),
      expected_(expected) {}

// One more vertex or triangle is there.
void MeshReader::note_done() {
    constexpr std::size_t between = 1 << 18;
    if (++done_ % between == 0 && in_.options.report)
        in_.options.report(static_cast<double>(done_) / expected_);
}

void MeshReader::add(int node, const glm::dmat4& to_world) {
    const int index = in_.model.nodes[node].mesh;
    for (std::size_t p = 0; p < in_.model.meshes[index].primitives.size(); ++p) {
        const auto& primitive = in_.model.meshes[index].primitives[p];
        const std::string where = fmt::format("meshes[{}].primitives[{}]", index, p);
        if (is_lines_or_points(primitive.mode)) {
            ++lines_and_points_;
            continue;
        }
        if (!primitive.attributes.contains("POSITION")) {
            ++without_position_;
            continue;
        }
        if (is_empty(in_.model, primitive)) continue;
        add_primitive(primitive, where, node, to_world);
    }
}

void MeshReader::add_primitive(const tinygltf::Primitive& primitive, const std::string& where,
                               int node, const glm::dmat4& to_world) {
    const int accessor = primitive.attributes.at("POSITION");
    std::vector<glm::vec4> positions =
        in_.accessors.vectors(accessor, Attribute::position, where + ".attributes.POSITION");
    const std::size_t count = positions.size();
    add_targets(primitive, "POSITION", node, where, positions);
    std::vector<glm::vec4> normals =
        attribute(primitive, "NORMAL", Attribute::normal, count, where);
    has_normals_ = has_normals_ || !normals.empty();
    add_targets(primitive, "NORMAL", node, where, normals);
    std::vector<glm::dmat4> moved;  // [vertex] to the world
    if (in_.model.nodes[node].skin >= 0) moved = skin(primitive, node, count, where);
    const Transform transform = [&](std::size_t v) -> glm::dmat4 {
        return moved.empty() ? to_world : to_world * moved[v];
    };
    const std::size_t base = scene_.vertices.size();
    if (base + count > 0xffffffffu)
        throw InputError("{}: {}: more than 2^32 vertices", scene_.file, where);
    glm::dmat4 m = transform(0);
    const bool mirrored = glm::determinant(glm::dmat3(m)) < 0;  // turns the winding round
    glm::dmat3 to_normal = glm::transpose(glm::inverse(glm::dmat3(m)));
    for (std::size_t v = 0; v < count; ++v) {
        note_done();
        if (!moved.empty()) {
            m = transform(v);
            to_normal = glm::transpose(glm::inverse(glm::dmat3(m)));
        }
        scene_.vertices.emplace_back(m * glm::dvec4(glm::vec3(positions[v]), 1));
        scene_.vertex_normals.emplace_back(
            normals.empty() ? glm::dvec3(0) : unit(to_normal * glm::dvec3(normals[v])));
        if (!(glm::compMax(glm::abs(scene_.vertices.back())) <= farthest))
            throw InputError(
                "{}: {}.attributes.POSITION: vertex {} is out of range in the world: more than "
                "{}",
                scene_.file, where, v, farthest);
    }
    const int material = material_of(in_.model, primitive);
    add_coordinates(primitive, material, count, where);
    add_tangents(primitive, material, node, transform, count, where);
    add_colors(primitive, count, where);
    add_triangles(corners(primitive, count, where), primitive.mode, base, mirrored, material);
}

// An attribute of `count` vertices; none where the primitive does not have it.
std::vector<glm::vec4> MeshReader::attribute(const tinygltf::Primitive& primitive,
                                             const std::string& name, Attribute kind,
                                             std::size_t count, const std::string& where) {
    const auto found = primitive.attributes.find(name);
    if (found == primitive.attributes.end()) return {};
    const std::string place = fmt::format("{}.attributes.{}", where, name);
    std::vector<glm::vec4> values = in_.accessors.vectors(found->second, kind, place);
    if (values.size() != count)
        throw InputError("{}: {}: {} values for {} positions", scene_.file, place, values.size(),
                         count);
    return values;
}

// Adds what the primitive's morph targets change of an attribute, by the node's weights.
void MeshReader::add_targets(const tinygltf::Primitive& primitive, const std::string& name,
                             int node, const std::string& where, std::vector<glm::vec4>& values) {
    const std::span<const float> weights = in_.pose.morph_weights(node);
    for (std::size_t t = 0; t < std::min(primitive.targets.size(), weights.size()); ++t) {
        const auto found = primitive.targets[t].find(name);
        if (found == primitive.targets[t].end() || weights[t] == 0 || values.empty()) continue;
        const std::string place = fmt::format("{}.targets[{}].{}", where, t, name);
        const Attribute kind = name == "POSITION" ? Attribute::position : Attribute::normal;
        const std::vector<glm::vec4> change = in_.accessors.vectors(found->second, kind, place);
        if (change.size() != values.size())
            throw InputError("{}: {}: {} values for {} vertices", scene_.file, place, change.size(),
                             values.size());
        for (std::size_t v = 0; v < values.size(); ++v)
            values[v] += glm::vec4(weights[t] * glm::vec3(change[v]), 0);
    }
}

// [vertex] the mean of its joints' matrices, to the world.
std::vector<glm::dmat4> MeshReader::skin(const tinygltf::Primitive& primitive, int node,
                                         std::size_t count, const std::string& where) {
    const std::vector<glm::dmat4> joints =
        in_.pose.joint_matrices(in_.model.nodes[node].skin, in_.accessors);
    std::vector<glm::dmat4> out(count, glm::dmat4(0));
    std::vector<double> sums(count, 0);
    for (int set = 0; primitive.attributes.contains(fmt::format("JOINTS_{}", set)); ++set) {
        const std::string name = fmt::format("JOINTS_{}", set);
        const std::vector<glm::vec4> numbers =
            attribute(primitive, name, Attribute::joints, count, where);
        const std::vector<glm::vec4> weights =
            attribute(primitive, fmt::format("WEIGHTS_{}", set), Attribute::weights, count, where);
        for (std::size_t v = 0; v < weights.size(); ++v)
            for (int k = 0; k < 4; ++k) {
                if (weights[v][k] == 0) continue;
                const auto joint = static_cast<std::size_t>(numbers[v][k]);
                if (joint >= joints.size())
                    throw InputError(
                        "{}: {}.attributes.{}: vertex {} has joint {}, but there are {}",
                        scene_.file, where, name, v, joint, joints.size());
                out[v] += double{weights[v][k]} * joints[joint];
                sums[v] += weights[v][k];
            }
    }
    for (std::size_t v = 0; v < count; ++v)
        out[v] = sums[v] > 0 ? out[v] / sums[v] : in_.pose.to_world(node);
    return out;
}

// Those that the scene's textures need; 0 where this primitive's do not.
void MeshReader::add_coordinates(const tinygltf::Primitive& primitive, int material,
                                 std::size_t count, const std::string& where) {
    for (std::size_t set = 0; set < coordinate_sets_.size(); ++set) {
        const std::string name = fmt::format("TEXCOORD_{}", coordinate_sets_[set]);
        std::vector<glm::vec2>& out = scene_.coordinates[set];
        if (!primitive.attributes.contains(name)) {
            if (needs_coordinates(material, set))
                in_.notes.add(where, fmt::format("lacks {}, where its material has a texture; "
                                                 "0 0 is taken at all vertices",
                                                 name));
            out.resize(out.size() + count, glm::vec2(0));
            continue;
        }
        for (const glm::vec4& v : attribute(primitive, name, Attribute::coordinates, count, where))
            out.emplace_back(v);
    }
}

bool MeshReader::needs_coordinates(int material, std::size_t set) const {
    const auto first = scene_.maps.begin() + MAP_KIND_COUNT * material;
    return std::any_of(first, first + MAP_KIND_COUNT, [&](const TextureMap& map) {
        return map.texture != NO_TEXTURE && map.set == set;
    });
}

// Where a normal map and vertex normals need them.
void MeshReader::add_tangents(const tinygltf::Primitive& primitive, int material, int node,
                              const Transform& transform, std::size_t count,
                              const std::string& where) {
    const bool used = primitive.attributes.contains("TANGENT") && !scene_.maps.empty() &&
                      scene_.maps[MAP_KIND_COUNT * material + MAP_NORMAL].texture != NO_TEXTURE;
    if (!used) {
        if (!scene_.tangents.empty()) scene_.tangents.resize(scene_.vertices.size(), float4(0));
        return;
    }
    scene_.tangents.resize(scene_.vertices.size() - count, float4(0));
    std::vector<glm::vec4> tangents =
        attribute(primitive, "TANGENT", Attribute::tangent, count, where);
    add_targets(primitive, "TANGENT", node, where, tangents);
    for (std::size_t v = 0; v < count; ++v) {
        const glm::dmat3 linear(transform(v));
        const glm::vec3 along(unit(linear * glm::dvec3(tangents[v])));
        const float side = (tangents[v].w < 0) == (glm::determinant(linear) < 0) ? 1.f : -1.f;
        scene_.tangents.push_back(along == glm::vec3(0) ? float4(0) : float4(along, side));
    }
}

void MeshReader::add_colors(const tinygltf::Primitive& primitive, std::size_t count,
                            const std::string& where) {
    if (!primitive.attributes.contains("COLOR_0")) {
        if (!scene_.colors.empty()) scene_.colors.resize(scene_.vertices.size(), float4(1));
        return;
    }
    scene_.colors.resize(scene_.vertices.size() - count, float4(1));
    for (const glm::vec4& v : attribute(primitive, "COLOR_0", Attribute::color, count, where))
        scene_.colors.push_back(glm::clamp(v, 0.f, 1.f));
}

void MeshReader::add_triangles(const std::vector<std::uint32_t>& corners, int mode,
                               std::size_t base, bool mirrored, int material) {
    const bool list = is_list(mode);
    const std::size_t count = list                  ? corners.size() / 3
                              : corners.size() >= 3 ? corners.size() - 2
                                                    : 0;
    for (std::size_t t = 0; t < count; ++t) {
        note_done();
        std::size_t c[3] = {3 * t, 3 * t + 1, 3 * t + 2};
        if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
            c[0] = t, c[1] = t + 1 + t % 2, c[2] = t + 2 - t % 2;
        } else if (mode == TINYGLTF_MODE_TRIANGLE_FAN) {
            c[0] = t + 1, c[1] = t + 2, c[2] = 0;
        }
        if (mirrored) std::swap(c[1], c[2]);
        for (const std::size_t corner : c)
            scene_.indices.push_back(static_cast<std::uint32_t>(base + corners[corner]));
        scene_.triangle_materials.push_back(material);
    }
}

// The vertices of a primitive's corners, in order.
std::vector<std::uint32_t> MeshReader::corners(const tinygltf::Primitive& primitive,
                                               std::size_t vertices, const std::string& where) {
    std::vector<std::uint32_t> corners;
    if (primitive.indices < 0) {
        corners.resize(vertices);
        for (std::size_t i = 0; i < vertices; ++i) corners[i] = static_cast<std::uint32_t>(i);
    } else {
        corners = in_.accessors.indices(primitive.indices, where + ".indices");
    }
    for (std::size_t i = 0; i < corners.size(); ++i)
        if (corners[i] >= vertices)
            throw InputError("{}: {}.indices: element {} is {}, but there are {} vertices",
                             scene_.file, where, i, corners[i], vertices);
    if (is_list(primitive.mode) && corners.size() % 3 != 0)
        throw InputError("{}: {}: {} corners are no whole number of triangles", scene_.file, where,
                         corners.size());
    return corners;
}

}  // namespace manylight
