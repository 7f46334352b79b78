// SPDX-License-Identifier: MIT
#include <cstring>
#include <filesystem>
#include <fstream>

#include "error.hpp"
#include "scene/gltf.hpp"

namespace manylight {
namespace {

constexpr int deepest_nesting = 128;  // 20,000 nested brackets overflow the parser's stack

std::vector<unsigned char> read_file(const std::string& path) {
    namespace fs = std::filesystem;
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!fs::exists(status)) throw InputError("{}: no such file", path);
    if (!fs::is_regular_file(status)) throw InputError("{}: not a regular file", path);
    const std::uintmax_t size = fs::file_size(path, error);
    if (error) throw InputError("{}: {}", path, error.message());
    // glb states its length in 32 bits, and the parser takes no more.
    if (size > 0xffffffffu)
        throw InputError("{}: {} bytes; a scene file has at most 4 GiB", path, size);
    std::vector<unsigned char> bytes(size);
    std::ifstream stream(path, std::ios::binary);
    if (!stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size)))
        throw InputError("{}: cannot be read: {}", path, std::strerror(errno));
    return bytes;
}

std::uint32_t word(const std::vector<unsigned char>& bytes, std::size_t offset) {
    std::uint32_t value;
    std::memcpy(&value, bytes.data() + offset, 4);
    return value;
}

// The JSON chunk of a .glb file; checks the header and every chunk's length.
std::string_view find_json_chunk(const GltfFile& file) {
    const auto& bytes = file.bytes;
    constexpr std::uint32_t json_type = 0x4e4f534a;
    constexpr std::uint32_t binary_type = 0x004e4942;
    if (bytes.size() < 20)
        throw InputError("{}: glb header: the file has {} bytes, fewer than 20", file.path,
                         bytes.size());
    if (word(bytes, 4) != 2)
        throw InputError("{}: glb header: version {} is not 2", file.path, word(bytes, 4));
    if (word(bytes, 8) != bytes.size())
        throw InputError("{}: glb header: length {} is not the file's, {}", file.path,
                         word(bytes, 8), bytes.size());
    std::string_view json;
    std::size_t offset = 12;
    for (int chunk = 0; offset < bytes.size(); ++chunk) {
        if (bytes.size() - offset < 8)
            throw InputError("{}: glb chunk {}: its header is cut off", file.path, chunk);
        const std::uint32_t length = word(bytes, offset);
        const std::uint32_t type = word(bytes, offset + 4);
        offset += 8;
        if (length > bytes.size() - offset)
            throw InputError("{}: glb chunk {}: length {}, but {} bytes are left", file.path, chunk,
                             length, bytes.size() - offset);
        if (chunk == 0 && type != json_type)
            throw InputError("{}: glb chunk 0: type {:#010x} is not JSON", file.path, type);
        if (chunk == 1 && type != binary_type)
            throw InputError("{}: glb chunk 1: type {:#010x} is not BIN", file.path, type);
        if (length % 4 != 0)
            throw InputError("{}: glb chunk {}: length {} is no multiple of 4", file.path, chunk,
                             length);
        if (chunk == 0) json = {reinterpret_cast<const char*>(bytes.data()) + offset, length};
        offset += length;
    }
    return json;
}

void check_nesting(const GltfFile& file, std::string_view text) {
    int depth = 0;
    bool in_string = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (in_string) {
            if (c == '\\')
                ++i;
            else if (c == '"')
                in_string = false;
        } else if (c == '"') {
            in_string = true;
        } else if (c == '[' || c == '{') {
            if (++depth > deepest_nesting)
                throw InputError("{}: JSON: byte {}: nested deeper than {} levels", file.path, i,
                                 deepest_nesting);
        } else if (c == ']' || c == '}') {
            --depth;
        }
    }
}

}  // namespace

std::filesystem::path path_of_uri(const GltfFile& file, const std::string& uri) {
    std::string path;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        if (uri[i] != '%' || i + 2 >= uri.size() || !std::isxdigit(uri[i + 1]) ||
            !std::isxdigit(uri[i + 2])) {
            path += uri[i];
            continue;
        }
        path += static_cast<char>(std::stoi(uri.substr(i + 1, 2), nullptr, 16));
        i += 2;
    }
    namespace fs = std::filesystem;
    std::error_code error;
    const fs::path folder = fs::absolute(file.path, error).parent_path();
    return path.empty() ? fs::path() : fs::weakly_canonical(folder / path, error);
}

std::vector<unsigned char> read_beside(const GltfFile& file, const std::string& uri,
                                       const std::string& where) {
    const std::filesystem::path path = path_of_uri(file, uri);
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error))
        throw InputError("{}: '{}': no such file beside the scene", where, uri);
    return read_file(path.string());
}

GltfFile read_gltf(const std::string& path) {
    GltfFile file;
    file.path = path;
    file.bytes = read_file(path);
    file.is_binary = file.bytes.size() >= 4 && std::memcmp(file.bytes.data(), "glTF", 4) == 0;
    const std::string_view text =
        file.is_binary
            ? find_json_chunk(file)
            : std::string_view(reinterpret_cast<const char*>(file.bytes.data()), file.bytes.size());
    check_nesting(file, text);
    try {
        file.json = nlohmann::json::parse(text);
    } catch (const nlohmann::json::exception& error) {
        // "[json.exception.parse_error.101] parse error at line 1 ...": the words after the tag
        const std::string words = error.what();
        throw InputError("{}: JSON: {}", path,
                         words.substr(std::min(words.find("] ") + 2, words.size())));
    }
    return file;
}

}  // namespace manylight
