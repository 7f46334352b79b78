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
    ~Allocation();
};

struct Device::Context {
    DeviceInfo info;
    DeviceForm form{};
    bool refuses_warnings = false;
    cl::Device device;
    cl::Context context;
    cl::CommandQueue queue;
    std::size_t allocated = 0;
    std::size_t peak = 0;
    double compile_seconds = 0;
    std::map<std::string, double> stage_seconds;
    std::vector<std::pair<std::string, cl::Event>> running;  // stage and event of each launch
    std::map<std::string, cl::Program> programs;             // by file and options
    std::set<Launched> launched;                             // see Device::take_launched()

    cl::Program& build(std::string_view file, const Defines& defines);
    void collect();  // waits, and adds the running launches to stage_seconds
};

struct Kernel::Built {
    std::shared_ptr<Device::Context> context;
    cl::Kernel kernel;
    std::string stage;
    std::string name;
    Launched launched;
    std::vector<std::string> parameters;
    std::map<bool, bool> compiled;  // by whether the launch was a small one
};

/// All devices, in the order of list_devices().
std::vector<cl::Device> all_devices();

/// The words for an OpenCL error.
std::string describe(const cl::Error& error);

}  // namespace manylight
