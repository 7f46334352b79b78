// SPDX-License-Identifier: MIT
#define GLM_ENABLE_EXPERIMENTAL
#include "scene/gltf/loading.hpp"

#include <glm/gtx/component_wise.hpp>

#include "error.hpp"
#include "scene/gltf/uri.hpp"

namespace manylight {
namespace {

// Those that the file names beside it.
std::vector<std::string> named_files(const GltfFile& file) {
    std::vector<std::string> files;
    for (const char* kind : {"buffers", "images"})
        if (file.json.contains(kind))
            for (const nlohmann::json& object : file.json[kind])
                if (object.contains("uri") &&
                    !object["uri"].get_ref<const std::string&>().starts_with("data:"))
                    files.push_back(file_of_uri(file, object["uri"], file.path).string());
    return files;
}

std::vector<int> nodes_of_scene(const tinygltf::Model& model) {
    if (model.scenes.empty()) return {};
    const std::vector<int>& roots = model.scenes[std::max(model.defaultScene, 0)].nodes;
    std::vector<int> nodes;
    std::vector<int> open(roots.rbegin(), roots.rend());
    while (!open.empty()) {
        const int index = open.back();
        open.pop_back();
        nodes.push_back(index);
        const std::vector<int>& children = model.nodes[index].children;
        open.insert(open.end(), children.rbegin(), children.rend());
    }
    return nodes;
}

std::optional<unsigned> wished_emitter_points(const tinygltf::Model& model) {
    if (model.scenes.empty()) return {};
    const tinygltf::Value& extras = model.scenes[std::max(model.defaultScene, 0)].extras;
    if (!extras.IsObject() || !extras.Has("emitter_points")) return {};
    return extras.Get("emitter_points").GetNumberAsInt();
}

}  // namespace

Loading::Loading(const GltfFile& file, const LoadOptions& options, const glm::dvec3& origin)
    : file(file),
      options(options),
      model(parse_gltf(file)),
      accessors(file, model),
      pose(file, model, accessors, options.seconds, origin),
      nodes(nodes_of_scene(model)),
      notes(file.notes) {
    scene.file = file.path;
    scene.files = named_files(file);
    scene.origin = origin;
    scene.emitter_points = wished_emitter_points(model);
}

void Loading::check_brightness(const glm::vec3& rgb, const std::string& where) const {
    if (!(glm::compMax(rgb) <= brightest))
        throw InputError("{}: {}: {} is out of range: more than {}", scene.file, where,
                         glm::compMax(rgb), brightest);
}

void Loading::check_transform(const glm::dmat4& to_world, int node) const {
    for (int c = 0; c < 4; ++c)
        if (!(glm::compMax(glm::abs(to_world[c])) <= farthest))
            throw InputError("{}: nodes[{}]: its transform is out of range: {} is more than {}",
                             scene.file, node, glm::compMax(glm::abs(to_world[c])), farthest);
}

}  // namespace manylight
