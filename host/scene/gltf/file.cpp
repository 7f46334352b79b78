// SPDX-License-Identifier: MIT
#include "scene/gltf/file.hpp"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>

#include "error.hpp"

namespace manylight {
namespace {

constexpr const char* meshopt_extensions[] = {"EXT_meshopt_compression", "KHR_meshopt_compression"};
constexpr int deepest_nesting = 128;  // 20,000 nested brackets overflow the parser's stack

std::uint32_t word(const std::vector<unsigned char>& bytes, std::size_t offset) {
    std::uint32_t value;
    std::memcpy(&value, bytes.data() + offset, 4);
    return value;
}

struct Chunk {
    std::uint32_t type;
    std::span<const unsigned char> bytes;
};

// The chunk of a .glb file that starts at `offset`; checks its length.
Chunk chunk_at(const std::string& path, const std::vector<unsigned char>& bytes, std::size_t offset,
               int number, Notes& notes) {
    const std::size_t left = bytes.size() - offset;
    if (left < 8) throw InputError("{}: glb chunk {}: its header is cut off", path, number);
    const std::uint32_t length = word(bytes, offset);
    if (length > left - 8)
        throw InputError("{}: glb chunk {}: length {}, but {} bytes are left", path, number, length,
                         left - 8);
    if (length % 4 != 0)
        notes.add(fmt::format("glb chunk {}", number),
                  "has a length that is no multiple of 4; it is read as long as it says");
    return {word(bytes, offset + 4), std::span(bytes).subspan(offset + 8, length)};
}

constexpr std::uint32_t json_type = 0x4e4f534a;
constexpr std::uint32_t binary_type = 0x004e4942;

// Where the chunk starts that follows one of `length` bytes at `begin`: right behind it, or behind
// padding that its length does not count.
std::size_t next_chunk(const std::vector<unsigned char>& bytes, std::size_t begin,
                       std::size_t length) {
    const std::size_t end = begin + length;
    const std::size_t padded = begin + (length + 3) / 4 * 4;
    const auto is_binary = [&](std::size_t at) {
        return at + 8 <= bytes.size() && word(bytes, at + 4) == binary_type;
    };
    const bool is_last = bytes.size() == padded;
    return is_last || (!is_binary(end) && is_binary(padded)) ? padded : end;
}

// The JSON chunk of a .glb file; checks the header and every chunk, and keeps the BIN chunk.
std::string_view find_chunks(const std::vector<unsigned char>& bytes, GltfFile& file) {
    constexpr std::uint32_t types[] = {json_type, binary_type};
    constexpr const char* names[] = {"JSON", "BIN"};
    if (bytes.size() < 20)
        throw InputError("{}: glb header: the file has {} bytes, fewer than 20", file.path,
                         bytes.size());
    if (word(bytes, 4) != 2)
        throw InputError(
            "{}: glb header: version {} is not 2; gltf-pipeline -i OLD -o NEW.glb converts glTF "
            "1.0",
            file.path, word(bytes, 4));
    if (word(bytes, 8) != bytes.size())
        throw InputError("{}: glb header: length {} is not the file's, {}", file.path,
                         word(bytes, 8), bytes.size());
    std::string_view json;
    std::size_t offset = 12;
    for (int number = 0; offset < bytes.size(); ++number) {
        const Chunk chunk = chunk_at(file.path, bytes, offset, number, file.notes);
        if (number < 2 && chunk.type != types[number])
            throw InputError("{}: glb chunk {}: type {:#010x} is not {}", file.path, number,
                             chunk.type, names[number]);
        if (number == 0)
            json = {reinterpret_cast<const char*>(chunk.bytes.data()), chunk.bytes.size()};
        if (number == 1) file.binary.emplace(chunk.bytes.begin(), chunk.bytes.end());
        offset = next_chunk(bytes, offset + 8, chunk.bytes.size());
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

GltfFile read_gltf(const std::string& path) {
    GltfFile file;
    file.path = path;
    const std::vector<unsigned char> bytes = read_file(path);
    const bool is_binary = bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0;
    const std::string_view text =
        is_binary ? find_chunks(bytes, file)
                  : std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size());
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

const char* compression_of(const nlohmann::json& view) {
    const auto extensions = view.find("extensions");
    if (extensions == view.end()) return nullptr;
    for (const char* name : meshopt_extensions)
        if (extensions->contains(name)) return name;
    return nullptr;
}

bool has_data(const GltfFile& file, std::size_t index) {
    const nlohmann::json& buffer = file.json["buffers"][index];
    for (const char* extension : meshopt_extensions) {
        const nlohmann::json::json_pointer fallback(
            fmt::format("/extensions/{}/fallback", extension));
        if (buffer.contains(fallback) && buffer[fallback] == true) return false;
    }
    return buffer.contains("uri") || (index == 0 && file.binary);
}

}  // namespace manylight
