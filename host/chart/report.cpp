// SPDX-License-Identifier: MIT
#include "chart/report.hpp"

#include <algorithm>

#include "output/error_picture.hpp"

namespace manylight {
namespace {

using nlohmann::json;

// Each pixel the mean of a square of them; what is left over at the edges is cut off.
Image shrink(const Image& image, unsigned by) {
    Image out(std::max(image.width / by, 1u), std::max(image.height / by, 1u), image.channels);
    for (unsigned y = 0; y < out.height; ++y)
        for (unsigned x = 0; x < out.width; ++x)
            for (int c = 0; c < 3; ++c) {
                double sum = 0;
                unsigned count = 0;
                for (unsigned j = y * by; j < std::min((y + 1) * by, image.height); ++j)
                    for (unsigned i = x * by; i < std::min((x + 1) * by, image.width); ++i) {
                        sum += image.at(i, j)[c];
                        ++count;
                    }
                out.at(x, y)[c] = static_cast<float>(sum / count);
            }
    return out;
}

// All images as data URIs, the reference first, `by` times smaller.
json encode_images(const Image& reference, const std::vector<ShownImage>& images, unsigned by,
                   std::size_t& bytes) {
    json uris = json::array();
    bytes = 0;
    Image small;
    const auto add = [&](const Image& image) {
        small = by == 1 ? image : shrink(image, by);
        uris.push_back(data_uri(pack(small)));
        bytes += uris.back().get_ref<const std::string&>().size();
    };
    add(reference);
    for (const ShownImage& shown : images) add(unpack(shown.image->packed));
    json colors = json::array();
    for (const auto& color : error_colors()) colors.push_back(color);
    return {{"width", small.width}, {"height", small.height},
            {"smaller_by", by},     {"exposure", auto_exposure(reference)},
            {"colors", colors},     {"uris", uris}};
}

// In a script element, where "</" would end it.
std::string embed(const json& data) {
    std::string out;
    for (const char c : data.dump(-1, ' ', true, json::error_handler_t::replace))
        out += c == '<' ? std::string("\\u003c") : std::string(1, c);
    return out;
}

}  // namespace

std::string make_report(const json& chart, const Image& reference,
                        const std::vector<ShownImage>& images) {
    std::size_t bytes = 0;
    json encoded = encode_images(reference, images, 1, bytes);
    for (unsigned by = 2; bytes > most_image_bytes; by *= 2)
        encoded = encode_images(reference, images, by, bytes);
    // The page's parts by their names in braces.
    const std::string_view page = report_sources.at("report.html");
    std::string out;
    std::size_t done = 0;
    for (std::size_t open = page.find("{{"); open != std::string_view::npos;
         open = page.find("{{", done)) {
        const std::size_t close = page.find("}}", open);
        const std::string_view name = page.substr(open + 2, close - open - 2);
        out += page.substr(done, open - done);
        if (name == "chart")
            out += embed(chart);
        else if (name == "images")
            out += embed(encoded);
        else
            out += report_sources.at(name);
        done = close + 2;
    }
    return out += page.substr(done);
}

}  // namespace manylight
