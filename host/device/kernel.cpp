// SPDX-License-Identifier: MIT
#include <chrono>
#include <stdexcept>

#include "device/context.hpp"
#include "device/kernel_sources.hpp"
#include "error.hpp"

namespace manylight {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

std::string build_options(const Defines& defines, const DeviceForm& form, bool refuses_warnings) {
    // -w: a warning of whatever compiler a driver brings concerns no user. -cl-kernel-arg-info:
    // arguments are set by name.
    std::string options = refuses_warnings ? "-cl-std=CL1.2 -Werror" : "-cl-std=CL1.2 -w";
    options += fmt::format(" -cl-kernel-arg-info -DLOCAL_SIZE={}", form.local_size);
    if (!defines.contains("LANES")) options += fmt::format(" -DLANES={}", form.lanes);
    if (form.lanes == 1) options += " -DPORTABLE_LANES=1";  // nothing of the processor's own
    for (const auto& [name, value] : defines) options += fmt::format(" -D{}={}", name, value);
    return options;
}

}  // namespace

cl::Program& Device::Context::build(std::string_view file, const Defines& defines) {
    const std::string options = build_options(defines, form, refuses_warnings);
    const std::string key = fmt::format("{} {}", file, options);
    const auto known = programs.find(key);
    if (known != programs.end()) return known->second;
    const auto start = Clock::now();
    cl::Program program(context, assemble_source(file));
    try {
        program.build(device, options.c_str());
    } catch (const cl::Error& error) {
        throw RuntimeError("{} ({}, driver {}): cannot build {}: {}\noptions: {}\n{}", info.name,
                           info.platform, info.driver, file, describe(error), options,
                           program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device));
    }
    compile_seconds += seconds_since(start);
    return programs.emplace(key, program).first->second;
}

Kernel Device::kernel(std::string_view file, const std::string& name, const Defines& defines,
                      const std::string& stage) {
    Kernel kernel;
    kernel.built_ = std::make_shared<Kernel::Built>();
    Kernel::Built& built = *kernel.built_;
    built.context = context_;
    built.stage = stage;
    built.name = name;
    built.launched = {std::string(file), name, stage, defines};
    try {
        built.kernel = cl::Kernel(context_->build(file, defines), name.c_str());
        const auto count = built.kernel.getInfo<CL_KERNEL_NUM_ARGS>();
        for (cl_uint i = 0; i < count; ++i) {
            std::string parameter = built.kernel.getArgInfo<CL_KERNEL_ARG_NAME>(i);
            while (!parameter.empty() && parameter.back() == '\0') parameter.pop_back();
            built.parameters.push_back(std::move(parameter));
        }
    } catch (const cl::Error& error) {
        throw RuntimeError("{}: {}: {}", context_->info.name, name, describe(error));
    }
    return kernel;
}

void Kernel::launch(std::size_t items, const Arguments& arguments) {
    if (items == 0) return;
    Device::Context& context = *built_->context;
    try {
        for (cl_uint i = 0; i < built_->parameters.size(); ++i) {
            const auto found = arguments.values_.find(built_->parameters[i]);
            if (found == arguments.values_.end())
                throw std::logic_error(fmt::format("kernel {} needs an argument '{}'", built_->name,
                                                   built_->parameters[i]));
            if (const auto* memory = std::get_if<DeviceMemory>(&found->second)) {
                if (!memory->allocation_)
                    throw std::logic_error(fmt::format("kernel {}: argument '{}' has no memory",
                                                       built_->name, built_->parameters[i]));
                built_->kernel.setArg(i, memory->allocation_->buffer);
            } else {
                const auto& bytes = std::get<std::vector<std::byte>>(found->second);
                built_->kernel.setArg(i, bytes.size(), bytes.data());
            }
        }
        const std::size_t local = context.form.local_size;
        const std::size_t global = (items + local - 1) / local * local;
        // Drivers compile at a kernel's first launch, PoCL once more for large ranges: what such a
        // launch takes beyond running counts as compiling.
        bool& compiled = built_->compiled[global < 65536];
        if (!compiled) context.collect();
        const auto start = Clock::now();
        cl::Event event;
        context.queue.enqueueNDRangeKernel(built_->kernel, cl::NullRange, global, local, nullptr,
                                           &event);
        context.running.emplace_back(built_->stage, event);
        if (!compiled) {
            const double before = context.stage_seconds[built_->stage];
            context.collect();
            context.compile_seconds +=
                seconds_since(start) - (context.stage_seconds[built_->stage] - before);
            compiled = true;
            context.launched.insert(built_->launched);
        }
    } catch (const cl::Error& error) {
        throw RuntimeError("{}: kernel {}: {}", context.info.name, built_->name, describe(error));
    }
}

}  // namespace manylight
