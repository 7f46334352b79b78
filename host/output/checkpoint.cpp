// SPDX-License-Identifier: MIT
// The file: a line, the render's name, and for each section its name, its number of bytes and
// these; at last a hash of all.
#include "output/checkpoint.hpp"

#include <fstream>
#include <sstream>

#include "output/hash.hpp"
#include "output/write_file.hpp"

namespace manylight {
namespace {

constexpr std::string_view magic = "manylight checkpoint 2\n";

void append(std::vector<std::byte>& out, std::span<const std::byte> bytes) {
    const std::uint64_t size = bytes.size();
    const auto head = std::as_bytes(std::span(&size, 1));
    out.insert(out.end(), head.begin(), head.end());
    out.insert(out.end(), bytes.begin(), bytes.end());
}

void append(std::vector<std::byte>& out, const std::string& text) {
    append(out, std::as_bytes(std::span(text)));
}

std::string hash_of(std::span<const std::byte> bytes) { return ContentHash().add(bytes).name(); }

// Takes what append() appended from the front of `rest`.
std::span<const std::byte> take(std::span<const std::byte>& rest) {
    std::uint64_t size = 0;
    if (rest.size() < sizeof(size)) throw InputError("it is cut off");
    std::memcpy(&size, rest.data(), sizeof(size));
    rest = rest.subspan(sizeof(size));
    if (rest.size() < size) throw InputError("it is cut off");
    const auto bytes = rest.first(size);
    rest = rest.subspan(size);
    return bytes;
}

std::string take_text(std::span<const std::byte>& rest) {
    const auto bytes = take(rest);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

Checkpoint parse(std::span<const std::byte> bytes) {
    constexpr std::size_t hash_size = 16;
    if (bytes.size() < magic.size() + hash_size ||
        std::memcmp(bytes.data(), magic.data(), magic.size()) != 0)
        throw InputError("is no checkpoint of this version of manylight");
    const auto content = bytes.first(bytes.size() - hash_size);
    if (std::memcmp(hash_of(content).data(), bytes.data() + content.size(), hash_size) != 0)
        throw InputError("is damaged: its hash does not fit its content");
    auto rest = content.subspan(magic.size());
    Checkpoint out{take_text(rest), {}};
    while (!rest.empty()) {
        const std::string name = take_text(rest);
        const auto values = take(rest);
        out.state.sections()[name].assign(values.begin(), values.end());
    }
    return out;
}

}  // namespace

void write_checkpoint(const std::string& path, const std::string& render, const FrameState& state) {
    const auto head = std::as_bytes(std::span(magic));
    std::vector<std::byte> out(head.begin(), head.end());
    append(out, render);
    for (const auto& [name, bytes] : state.sections()) {
        append(out, name);
        append(out, bytes);
    }
    const std::string hash = hash_of(out);
    const auto tail = std::as_bytes(std::span(hash));
    out.insert(out.end(), tail.begin(), tail.end());
    write_file(path, out);
}

Checkpoint read_checkpoint(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw InputError("--resume: {}: cannot be read: {}", path, std::strerror(errno));
    std::stringstream all;
    all << file.rdbuf();
    const std::string text = std::move(all).str();
    try {
        return parse(std::as_bytes(std::span(text)));
    } catch (const InputError& error) {
        throw InputError("--resume: {}: {}", path, error.what());
    }
}

}  // namespace manylight
