// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "commands/commands.hpp"
#include "error.hpp"
#include "output/error_picture.hpp"
#include "output/metrics.hpp"
#include "output/write_file.hpp"
#include "print.hpp"

namespace manylight {
namespace {

using nlohmann::json;

struct Judged {
    std::string file;
    Image image;
    Difference difference;
};

json to_json(const Difference& d) {
    return {{"relmse", d.relmse},
            {"mape", d.mape},
            {"rmse", d.rmse},
            {"bias", d.bias},
            {"worst_1_percent", d.worst_hundredth},
            {"worst_0.1_percent", d.worst_thousandth},
            {"not_finite", d.bad}};
}

void print(const Difference& d) {
    say("relMSE {:.6g}, MAPE {:.6g}, RMSE {:.6g} cd/m2, mean {:+.4f}%, of the error in the worst "
        "1% of pixels {:.1f}%, in the worst 0.1% {:.1f}%\n",
        d.relmse, d.mape, d.rmse, 100 * d.bias, 100 * d.worst_hundredth, 100 * d.worst_thousandth);
}

void print(const std::vector<Judged>& judged) {
    for (const Judged& j : judged) {
        if (judged.size() > 1) say("{}: ", j.file);
        print(j.difference);
    }
    if (judged.size() < 2) return;
    const Difference& a = judged[0].difference;
    const Difference& b = judged[1].difference;
    say("{} over {}: relMSE {:.4g}, MAPE {:.4g}\n", judged[1].file, judged[0].file,
        b.relmse / a.relmse, b.mape / a.mape);
}

void print_json(const std::vector<Judged>& judged, const std::string& reference) {
    json out = to_json(judged[0].difference);
    if (judged.size() > 1) {
        out = {{"reference", reference}};
        for (const Judged& j : judged) {
            out["images"].push_back(to_json(j.difference));
            out["images"].back()["file"] = j.file;
        }
    }
    say("{}\n", out.dump(-1, ' ', true, json::error_handler_t::replace));
}

void write_picture(const std::string& path, const std::vector<Judged>& judged) {
    std::vector<ErrorPanel> panels;
    for (const Judged& j : judged)
        panels.push_back({fmt::format("{}: relMSE {:.4g}", j.file, j.difference.relmse),
                          j.image.width, j.image.height, j.difference.pixels});
    write_png(path, draw_error_picture(panels), 1, {});
}

}  // namespace

int run_compare(const CompareArguments& arguments) {
    std::vector<std::string> files = {arguments.image};
    std::string reference_file = arguments.other;
    if (!arguments.reference.empty()) {
        files.push_back(arguments.other);
        reference_file = arguments.reference;
    }
    if (!arguments.output.empty()) {
        const std::string ending = ".png";
        check_output("--output", arguments.output, {&ending, 1});
        for (const std::string& input : {arguments.image, arguments.other, arguments.reference})
            if (same_file(arguments.output, input))
                throw InputError("--output {}: is one of the images", arguments.output);
    }
    const Image reference = read_rgb(reference_file);
    std::vector<Judged> judged;
    std::size_t bad = 0;
    for (const std::string& file : files) {
        Judged j{file, read_rgb(file), {}};
        j.difference = compare_images(j.image, reference, file, reference_file);
        const Difference& d = j.difference;
        if (d.bad > 0)
            warn(
                "{}: {} of its values are no finite numbers, the first at {}; "
                "they are left out",
                file, d.bad, place_of_value(j.image, d.first_bad));
        bad += d.bad;
        judged.push_back(std::move(j));
    }
    if (arguments.json)
        print_json(judged, reference_file);
    else
        print(judged);
    if (!arguments.output.empty()) {
        write_picture(arguments.output, judged);
        if (!arguments.json) say("wrote {}\n", arguments.output);
    }
    return bad > 0 ? 3 : 0;
}

}  // namespace manylight
