// SPDX-License-Identifier: MIT
#include "commands/commands.hpp"
#include "device/device.hpp"
#include "print.hpp"

namespace manylight {
namespace {

std::string describe(const DeviceForm& form) {
    if (form.lanes == 1) return "GPUs: a ray or a pixel per work-item";
    return fmt::format("{} lanes: 16 rays or pixels per work-item, in vectors", form.lanes);
}

}  // namespace

int run_devices() {
    const std::vector<DeviceInfo> devices = list_devices();
    std::size_t chosen = devices.size();
    try {
        chosen = select_device("");
    } catch (const std::exception&) {  // none is usable: the list says why, if there is one
        if (devices.empty()) throw;
    }
    for (std::size_t i = 0; i < devices.size(); ++i) {
        const DeviceInfo& d = devices[i];
        say("{}: {}{}\n", i, d.name, i == chosen ? "  (default)" : "");
        say("   {}, {}, {}, {}, driver {}\n", d.type, d.platform, d.version, d.language, d.driver);
        say("   {} compute units, vectors of {} floats, {:.1f} GiB memory, at most {:.1f} "
            "GiB in a buffer\n",
            d.compute_units, d.float_width, static_cast<double>(d.global_memory) / (1 << 30),
            static_cast<double>(d.max_allocation) / (1 << 30));
        if (d.usable)
            say("   can render, in the form of {}\n", describe(form_for(d)));
        else
            say("   cannot render: needs OpenCL 1.2, a compiler and little-endian memory\n");
        if (const std::string trouble = known_trouble(d); !trouble.empty())
            say("   known trouble: {}; 'manylight verify --device {}' tells\n", trouble, i);
    }
    return 0;
}

}  // namespace manylight
