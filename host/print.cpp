// SPDX-License-Identifier: MIT
#include "print.hpp"

#include <cstdint>

namespace manylight {
namespace {

struct Character {
    std::uint32_t code;
    std::size_t bytes;  // 0: no UTF-8 is there
};

// Source: RFC 3629.
Character character_at(std::string_view text, std::size_t at) {
    const auto byte = [&](std::size_t i) -> std::uint32_t {
        return at + i < text.size() ? static_cast<unsigned char>(text[at + i]) : 0;
    };
    const std::uint32_t first = byte(0);
    if (first < 0x80) return {first, 1};
    const std::size_t bytes = first >> 5 == 6 ? 2 : first >> 4 == 14 ? 3 : first >> 3 == 30 ? 4 : 0;
    if (bytes == 0) return {0, 0};
    std::uint32_t code = first & (0xff >> (bytes + 1));
    for (std::size_t i = 1; i < bytes; ++i) {
        if ((byte(i) & 0xc0) != 0x80) return {0, 0};
        code = code << 6 | (byte(i) & 0x3f);
    }
    constexpr std::uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    const bool is_surrogate = code >= 0xd800 && code < 0xe000;
    if (code < least[bytes] || code > 0x10ffff || is_surrogate) return {0, 0};
    return {code, bytes};
}

bool is_harmful(std::uint32_t c) {
    return c < 0x20 || (c >= 0x7f && c < 0xa0)              // controls
           || c == 0x061c || c == 0x200e || c == 0x200f     // marks of direction
           || (c >= 0x2028 && c <= 0x202e)                  // line breaks, overrides
           || (c >= 0x2066 && c <= 0x2069) || c == 0xfeff;  // isolates; an invisible one
}

std::string escape_of(std::uint32_t c) {
    if (c == '\n') return "\\n";
    if (c == '\r') return "\\r";
    if (c == '\t') return "\\t";
    return c < 0x80 ? fmt::format("\\x{:02x}", c) : fmt::format("\\u{:04x}", c);
}

}  // namespace

std::string escaped(std::string_view text, bool lines) {
    std::string out;
    for (std::size_t i = 0; i < text.size();) {
        const Character c = character_at(text, i);
        if (c.bytes == 0) {
            out += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[i++]));
            continue;
        }
        const bool stays = lines && (c.code == '\n' || c.code == '\t');
        out +=
            is_harmful(c.code) && !stays ? escape_of(c.code) : std::string(text.substr(i, c.bytes));
        i += c.bytes;
    }
    return out;
}

bool standard_output_fails() { return std::fflush(stdout) != 0 || std::ferror(stdout) != 0; }

}  // namespace manylight
