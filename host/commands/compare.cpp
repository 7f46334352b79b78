// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "commands/commands.hpp"
#include "output/metrics.hpp"

namespace manylight {

int run_compare(const std::string& image, const std::string& reference, bool json) {
    const Difference d = compare_images(read_rgb(image), read_rgb(reference), image, reference);
    if (json) {
        const nlohmann::json out = {
            {"relmse", d.relmse}, {"rmse", d.rmse}, {"bias", d.bias}, {"not_finite", d.bad}};
        fmt::print("{}\n", out.dump());
    } else {
        fmt::print("relMSE {:.6g}, RMSE {:.6g} cd/m2, mean {:+.4f}%\n", d.relmse, d.rmse,
                   100 * d.bias);
        if (d.bad > 0) fmt::print("{} values are not finite\n", d.bad);
    }
    return d.bad > 0 ? 3 : 0;
}

}  // namespace manylight
