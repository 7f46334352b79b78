// SPDX-License-Identifier: MIT
#include "scene/gltf/uri.hpp"

#include <algorithm>
#include <cctype>
#include <optional>

#include "error.hpp"
#include "print.hpp"

namespace manylight {
namespace {

namespace fs = std::filesystem;

std::optional<unsigned> hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return {};
}

// A % without two hexadecimal digits stands for itself.
std::string decode_percents(std::string_view text) {
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool coded = text[i] == '%' && i + 2 < text.size() && hex_digit(text[i + 1]) &&
                           hex_digit(text[i + 2]);
        if (!coded) {
            out += text[i];
            continue;
        }
        out += static_cast<char>(16 * *hex_digit(text[i + 1]) + *hex_digit(text[i + 2]));
        i += 2;
    }
    return out;
}

// What keeps a decoded path from being a plain relative one; null if nothing does.
const char* objection(const std::string& path) {
    const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
    if (path.empty()) return "names no file";
    if (std::ranges::any_of(path, is_control)) return "holds a control character";
    if (path.find(':') != std::string::npos)
        return "holds a colon: only files beside the scene are read";
    if (path.find('\\') != std::string::npos) return "holds a backslash: folders are parted by /";
    const fs::path relative(path);
    if (relative.is_absolute() || std::ranges::find(relative, fs::path("..")) != relative.end())
        return "leads outside the scene's folder";
    return nullptr;
}

std::optional<unsigned> base64_digit(char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    if (c == '+') return 62;
    if (c == '/') return 63;
    return {};
}

// None where a character is no base64.
std::optional<std::vector<unsigned char>> decode_base64(std::string_view text) {
    std::vector<unsigned char> out;
    out.reserve(text.size() / 4 * 3);
    unsigned bits = 0;
    int count = 0;
    for (const char c : text) {
        if (c == '=') break;
        if (std::isspace(static_cast<unsigned char>(c))) continue;
        const std::optional<unsigned> digit = base64_digit(c);
        if (!digit) return {};
        bits = bits << 6 | *digit;
        count += 6;
        if (count < 8) continue;
        count -= 8;
        out.push_back(static_cast<unsigned char>(bits >> count & 0xff));
    }
    return out;
}

std::string shortened(const std::string& uri) {
    return escaped(uri.size() <= 60 ? uri : uri.substr(0, 57) + "...");
}

}  // namespace

fs::path file_of_uri(const GltfFile& file, const std::string& uri, const std::string& where) {
    const std::string path = decode_percents(uri);
    if (const char* why = objection(path))
        throw InputError("{}: '{}' {}", where, shortened(uri), why);
    std::error_code error;
    const fs::path named = fs::absolute(file.path, error).parent_path();
    const fs::path folder = fs::weakly_canonical(named, error);
    const fs::path target = fs::weakly_canonical(named / path, error);
    if (error) throw InputError("{}: '{}': {}", where, shortened(uri), error.message());
    if (std::ranges::mismatch(folder, target).in1 != folder.end())
        throw InputError("{}: '{}' leads outside the scene's folder, by a link", where,
                         shortened(uri));
    return target;
}

std::vector<unsigned char> bytes_of_uri(const GltfFile& file, const std::string& uri,
                                        const std::string& where) {
    if (uri.starts_with("data:")) {
        const std::string_view coded = std::string_view(uri).substr(uri.find(',') + 1);
        auto bytes = coded.find('%') == std::string::npos ? decode_base64(coded)
                                                          : decode_base64(decode_percents(coded));
        if (!bytes) throw InputError("{}: '{}...' holds no base64 data", where, uri.substr(0, 40));
        return std::move(*bytes);
    }
    const fs::path path = file_of_uri(file, uri, where);
    std::error_code error;
    if (!fs::is_regular_file(path, error))
        throw InputError("{}: '{}': no such file beside the scene", where, shortened(uri));
    return read_file(path.string());
}

}  // namespace manylight
