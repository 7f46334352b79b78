// SPDX-License-Identifier: MIT
// The OpenCL objects behind device.hpp; included by host/device/*.cpp only.
#pragma once

#define CL_HPP_ENABLE_EXCEPTIONS
#define CL_HPP_MINIMUM_OPENCL_VERSION 120
#define CL_HPP_TARGET_OPENCL_VERSION 120
#include <CL/opencl.hpp>

#include "device/device.hpp"

namespace manylight {

struct DeviceMemory::Allocation {
    std::shared_ptr<Device::Context> context;
    cl::Buffer buffer;
    std::size_t bytes = 0;
    std::shared_ptr<MemoryUse> use;  // that they count for, if any
    ~Allocation();
};

struct Device::Context {
    DeviceInfo info;
    DeviceForm form{};
    std::size_t number = 0;  // in list_devices()
    std::shared_ptr<Compilers> compilers;
    bool refuses_warnings = false;
    cl::Device device;
    cl::Context context;
    cl::CommandQueue queue;
    std::size_t allocated = 0;
    std::size_t peak = 0;
    std::shared_ptr<MemoryUse> use;  // that allocations count for, if any
    double compile_seconds = 0;
    std::map<std::string, double> stage_seconds;
    std::vector<std::pair<std::string, cl::Event>> running;  // stage and event of each launch
    std::map<std::string, cl::Program> programs;             // by file and options
    std::vector<std::shared_ptr<Kernel::Built>> waiting;     // kernels that are not built
    std::set<Launched> launched;                             // see Device::take_launched()

    [[nodiscard]] std::string options(const Defines& defines) const;
    // Builds a program once. Throws RuntimeError.
    cl::Program& build(const std::string& file, const std::string& options);
    void collect();  // waits, and adds the running launches to stage_seconds
};

struct Kernel::Built {
    struct Parameter {
        std::string name;
        std::string type;  // as the driver names it: "uint", "float4*"
    };

    Device::Context* context;  // which the kernel's owner keeps
    std::string file;
    std::string options;
    std::string stage;
    std::string name;
    Launched launched;
    std::size_t expected_items = 0;
    cl::Kernel kernel;
    std::vector<Parameter> parameters;  // empty until it is built
    std::map<bool, bool> compiled;      // by whether the launch was a small one

    void build();
};

/// PoCL compiles a kernel for launches of fewer work-items apart from one for more.
constexpr std::size_t few_items = 65536;

/// All devices, in the order of list_devices().
std::vector<cl::Device> all_devices();

/// The words for an OpenCL error.
std::string describe(const cl::Error& error);

}  // namespace manylight
