// SPDX-License-Identifier: MIT
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "device/context.hpp"
#include "error.hpp"

namespace manylight {
namespace {

constexpr const char* pocl = "Portable Computing Language";

std::string trimmed(std::string text) {
    while (!text.empty() && (text.back() == '\0' || text.back() == ' ')) text.pop_back();
    return text;
}

std::string lower(std::string text) {
    std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
}

DeviceInfo describe_device(const cl::Device& device) {
    DeviceInfo info;
    const cl::Platform platform(device.getInfo<CL_DEVICE_PLATFORM>());
    info.platform = trimmed(platform.getInfo<CL_PLATFORM_NAME>());
    info.name = trimmed(device.getInfo<CL_DEVICE_NAME>());
    info.version = trimmed(device.getInfo<CL_DEVICE_VERSION>());
    info.language = trimmed(device.getInfo<CL_DEVICE_OPENCL_C_VERSION>());
    info.driver = trimmed(device.getInfo<CL_DRIVER_VERSION>());
    const cl_device_type type = device.getInfo<CL_DEVICE_TYPE>();
    info.is_gpu = type & CL_DEVICE_TYPE_GPU;
    info.type = info.is_gpu                         ? "GPU"
                : type & CL_DEVICE_TYPE_CPU         ? "CPU"
                : type & CL_DEVICE_TYPE_ACCELERATOR ? "accelerator"
                                                    : "other";
    info.compute_units = device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>();
    info.global_memory = device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>();
    info.max_allocation = device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>();
    info.float_width = std::max(device.getInfo<CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT>(), 1u);
    info.usable =
        device.getInfo<CL_DEVICE_AVAILABLE>() && device.getInfo<CL_DEVICE_COMPILER_AVAILABLE>() &&
        device.getInfo<CL_DEVICE_ENDIAN_LITTLE>() && !info.version.starts_with("OpenCL 1.0") &&
        !info.version.starts_with("OpenCL 1.1") &&
        device.getInfo<CL_DEVICE_MAX_WORK_GROUP_SIZE>() >= form_for(info).local_size;
    return info;
}

// PoCL lists no device where its kernel cache cannot be made, and fails to build with an unhelpful
// message where it cannot be written.
void check_pocl_cache() {
    namespace fs = std::filesystem;
    const auto variable = [](const char* name) {
        const char* value = std::getenv(name);
        return std::string(value ? value : "");
    };
    fs::path folder = variable("POCL_CACHE_DIR");
    if (folder.empty() && !variable("XDG_CACHE_HOME").empty())
        folder = fs::path(variable("XDG_CACHE_HOME")) / "pocl/kcache";
    if (folder.empty() && !variable("HOME").empty())
        folder = fs::path(variable("HOME")) / ".cache/pocl/kcache";
    if (folder.empty()) return;  // PoCL then uses a folder of its own in /tmp
    std::error_code error;
    fs::create_directories(folder, error);
    const fs::path probe = folder / fmt::format("manylight-{}", getpid());
    const bool writable = !error && std::ofstream(probe).put('\n').flush().good();
    fs::remove(probe, error);
    if (!writable)
        throw RuntimeError(
            "PoCL's kernel cache {} cannot be written; set POCL_CACHE_DIR to a folder that can",
            folder.string());
}

bool contains(const std::string& text, std::string_view part) {
    return lower(text).find(lower(std::string(part))) != std::string::npos;
}

// The device of that name, or those whose platform or version, or else whose name, holds the words.
std::vector<std::size_t> matching(const std::vector<DeviceInfo>& devices, std::string_view words) {
    const auto named = std::ranges::find(devices, words, &DeviceInfo::name);
    if (named != devices.end() && std::ranges::count(devices, words, &DeviceInfo::name) == 1)
        return {static_cast<std::size_t>(named - devices.begin())};
    std::vector<std::size_t> by_platform;
    std::vector<std::size_t> by_name;
    for (std::size_t i = 0; i < devices.size(); ++i) {
        if (contains(devices[i].platform + " " + devices[i].version, words))
            by_platform.push_back(i);
        if (contains(devices[i].name, words)) by_name.push_back(i);
    }
    return by_platform.empty() ? by_name : by_platform;
}

std::size_t default_device(const std::vector<DeviceInfo>& devices) {
    const auto find = [&](auto&& matches) {
        const auto found = std::ranges::find_if(
            devices, [&](const DeviceInfo& d) { return d.usable && matches(d); });
        return static_cast<std::size_t>(found - devices.begin());
    };
    std::size_t index = find([](const DeviceInfo& d) { return d.is_gpu; });
    if (index == devices.size())
        index =
            find([](const DeviceInfo& d) { return d.platform == "Portable Computing Language"; });
    if (index == devices.size()) index = find([](const DeviceInfo&) { return true; });
    return index;
}

}  // namespace

std::string known_trouble(const DeviceInfo& device) {
    struct Trouble {
        std::string_view platform;  // or a part of it
        std::string_view version;   // part of that of OpenCL
        const char* what;
    };
    // With where it is reported.
    constexpr Trouble table[] = {
        // github.com/Khanattila/KNLMeansCL/issues/55 (OpenCL 1.1), weldr/lorax/pull/1498 (dropped)
        {"Clover", "", "Mesa's Clover stays below OpenCL 1.2 and left Mesa in 25.2; try rusticl"},
        // github.com/pocl/pocl/issues/446
        {pocl, "pocl 0.", "PoCL before 1.0 miscompiles large kernels"},
        // github.com/pocl/pocl/issues/2069: right in 6.1, wrong in 7.0 and 7.1
        {pocl, "PoCL 7.0", "PoCL 7.0 miscompiles some kernels that 6.1 compiles correctly"},
        {pocl, "PoCL 7.1", "PoCL 7.1 miscompiles some kernels that 6.1 compiles correctly"},
        // github.com/ddemidov/vexcl/pull/231
        {"Apple", "", "Apple's compiler breaks functions that return vectors, and some loops"},
        // github.com/darktable-org/darktable/issues/21662
        {"rusticl", "",
         "rusticl fails to compile where Mesa uses the libclc of LLVM 22, unpatched"},
    };
    for (const Trouble& trouble : table)
        if (contains(device.platform, trouble.platform) &&
            contains(device.version, trouble.version))
            return trouble.what;
    return "";
}

DeviceForm form_of(unsigned lanes) {
    return lanes == 1 ? DeviceForm{1, 1, 4, 64} : DeviceForm{lanes, 16, lanes, 16};
}

DeviceForm form_for(const DeviceInfo& device) {
    if (device.is_gpu) return form_of(1);
    return form_of(device.float_width >= 16 ? 16 : device.float_width >= 8 ? 8 : 4);
}

std::vector<cl::Device> all_devices() {
    std::vector<cl::Device> all;
    std::vector<cl::Platform> platforms;
    // PoCL aborts where it is set and empty.
    const char* cache = std::getenv("POCL_CACHE_DIR");
    if (cache != nullptr && *cache == '\0') unsetenv("POCL_CACHE_DIR");
    try {
        cl::Platform::get(&platforms);
    } catch (const cl::Error&) {  // the loader reports "no platforms" as an error
        return all;
    }
    for (const cl::Platform& platform : platforms) {
        std::vector<cl::Device> devices;
        try {
            platform.getDevices(CL_DEVICE_TYPE_ALL, &devices);
        } catch (const cl::Error&) {  // a platform without devices does too
            continue;
        }
        all.insert(all.end(), devices.begin(), devices.end());
    }
    return all;
}

std::vector<DeviceInfo> list_devices() {
    std::vector<DeviceInfo> infos;
    for (const cl::Device& device : all_devices()) infos.push_back(describe_device(device));
    return infos;
}

std::size_t select_device(std::string_view selector) {
    const std::vector<DeviceInfo> devices = list_devices();
    std::size_t index = devices.size();
    if (selector.empty()) {
        index = default_device(devices);
        if (index == devices.size()) {
            check_pocl_cache();
            throw RuntimeError(
                "no usable OpenCL device: install a driver, such as Debian's pocl-opencl-icd");
        }
    } else if (std::ranges::all_of(selector, [](unsigned char c) { return std::isdigit(c); })) {
        index = selector.size() < 6 ? std::stoul(std::string(selector)) : devices.size();
    } else {
        const std::vector<std::size_t> found = matching(devices, selector);
        if (found.size() > 1)
            throw InputError("--device {}: devices {} match: give one's number", selector,
                             fmt::join(found, " and "));
        if (!found.empty()) index = found.front();
    }
    if (index >= devices.size())
        throw InputError("--device {}: no such device ('manylight devices' lists the {} there are)",
                         selector, devices.size());
    if (!devices[index].usable)
        throw InputError("--device {}: {} cannot be used (needs OpenCL 1.2 and a compiler)",
                         selector, devices[index].name);
    if (devices[index].platform == pocl) check_pocl_cache();
    return index;
}

}  // namespace manylight
