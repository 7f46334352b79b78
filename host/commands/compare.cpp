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
    const Difference& a = judged[0].difference;
    for (std::size_t i = 1; i < judged.size(); ++i) {
        const Difference& b = judged[i].difference;
        say("{} over {}: relMSE {:.4g}, MAPE {:.4g}\n", judged[i].file, judged[0].file,
            b.relmse / a.relmse, b.mape / a.mape);
    }
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

// The stops by which a picture for a screen was exposed, as its header tells; 0 of radiance.
std::string stops_of(const std::string& file) {
    const auto facts = read_facts(file);
    const auto exposure = facts.find("exposure");
    return exposure == facts.end() ? "0" : exposure->second;
}

void warn_of_exposure(const std::string& file, const std::string& reference) {
    const auto words = [](const std::string& stops) {
        return stops == "0" ? "not exposed" : "exposed by " + stops + " stops";
    };
    const std::string a = stops_of(file);
    const std::string b = stops_of(reference);
    if (a != b)
        warn(
            "{} is {}, {} {}: the figures tell of that too; compare .exr files, or give both "
            "renders the same --exposure",
            file, words(a), reference, words(b));
}

}  // namespace

int run_compare(const CompareArguments& arguments) {
    const std::string& reference_file = arguments.reference;
    if (!arguments.output.empty()) {
        const std::string ending = ".png";
        check_output("--output", arguments.output, {&ending, 1});
        std::vector<std::string> inputs = arguments.images;
        inputs.push_back(reference_file);
        for (const std::string& input : inputs)
            if (same_file(arguments.output, input))
                throw InputError("--output {}: is one of the images", arguments.output);
    }
    const Image reference = read_rgb(reference_file);
    std::vector<Judged> judged;
    std::size_t bad = 0;
    for (const std::string& file : arguments.images) {
        Judged j{file, read_rgb(file), {}};
        j.difference = compare_images(j.image, reference, file, reference_file);
        warn_of_exposure(file, reference_file);
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
