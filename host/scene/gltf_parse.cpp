// SPDX-License-Identifier: MIT
// tinygltf's implementation, alone in its file: it takes long to compile.
#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#include "scene/gltf_parse.hpp"

#include <filesystem>

#include "error.hpp"

namespace manylight {

tinygltf::Model parse_gltf(const GltfFile& file) {
    tinygltf::TinyGLTF parser;
    const auto skip_image = [](tinygltf::Image*, const int, std::string*, std::string*, int, int,
                               const unsigned char*, int, void*) { return true; };
    parser.SetImageLoader(skip_image, nullptr);
    tinygltf::Model model;
    std::string error;
    std::string warning;
    const auto length = static_cast<unsigned>(file.bytes.size());
    const std::string folder = std::filesystem::absolute(file.path).parent_path().string();
    const bool parsed = file.is_binary
                            ? parser.LoadBinaryFromMemory(&model, &error, &warning,
                                                          file.bytes.data(), length, folder)
                            : parser.LoadASCIIFromString(
                                  &model, &error, &warning,
                                  reinterpret_cast<const char*>(file.bytes.data()), length, folder);
    if (!parsed) {
        while (!error.empty() && error.back() == '\n') error.pop_back();
        std::ranges::replace(error, '\n', ' ');
        throw InputError("{}: {}", file.path, error.substr(0, 300));
    }
    return model;
}

}  // namespace manylight
