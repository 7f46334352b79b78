// SPDX-License-Identifier: MIT
#include <cxxabi.h>

#include <stdexcept>

#include "clock.hpp"
#include "device/context.hpp"
#include "device/kernel_sources.hpp"
#include "error.hpp"

namespace manylight {
namespace {

void erase_all(std::string& text, std::string_view word) {
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word))
        text.erase(at, word.size());
}

// A kernel's parameter's name or type, without what some drivers add.
std::string trimmed(std::string text) {
    while (!text.empty() && text.back() == '\0') text.pop_back();
    for (const char* word : {"struct ", "const ", "__global "}) erase_all(text, word);
    const std::string_view number = "unsigned int";
    return text.starts_with(number) ? fmt::format("uint{}", text.substr(number.size())) : text;
}

// Not every driver knows the types.
std::string type_of(const cl::Kernel& kernel, cl_uint parameter) {
    try {
        return trimmed(kernel.getArgInfo<CL_KERNEL_ARG_TYPE_NAME>(parameter));
    } catch (const cl::Error&) {
        return "";
    }
}

// Of a type of elements the number's: of "float", "float4" and "float_n", "float".
std::string_view number_of(std::string_view type) {
    if (type.size() > 2 && type[type.size() - 2] == '_') type.remove_suffix(2);
    return type.substr(0, type.find_last_not_of("0123456789") + 1);
}

// Whether a parameter, of a type as the driver names it, takes an argument of a type.
bool takes(std::string_view parameter, std::string_view type, bool is_buffer) {
    if (parameter.empty()) return true;  // not every driver tells
    if (!is_buffer) return parameter == type;
    const std::size_t end = parameter.find_last_not_of(" *");
    return parameter.ends_with('*') && number_of(parameter.substr(0, end + 1)) == number_of(type);
}

}  // namespace

std::string opencl_name(const std::type_info& type) {
    int status = 0;
    char* const text = abi::__cxa_demangle(type.name(), nullptr, nullptr, &status);
    const std::string whole = text != nullptr ? text : type.name();
    std::free(text);
    std::string_view name = whole;
    std::string_view lanes;
    if (name.starts_with("glm::vec<")) {  // "glm::vec<4, float, (glm::qualifier)0>"
        lanes = name.substr(9, 1);
        name = name.substr(12, name.find(',', 12) - 12);
    } else if (name.starts_with("std::array<")) {  // "std::array<unsigned int, 4ul>"
        lanes = name.substr(name.find(',') + 2, 1);
        name = name.substr(11, name.find(',') - 11);
    }
    if (name == "unsigned int") name = "uint";
    if (name == "unsigned char") name = "uchar";
    if (const std::size_t space = name.rfind("::"); space != std::string_view::npos)
        name.remove_prefix(space + 2);
    return fmt::format("{}{}", name, lanes);
}

Arguments& Arguments::put(std::string name, Content content, const std::string& type) {
    values_.insert_or_assign(std::move(name), Value{std::move(content), &type});
    return *this;
}

std::string Device::Context::options(const Defines& defines) const {
    // -w: a warning of whatever compiler a driver brings concerns no user. -cl-kernel-arg-info:
    // arguments are set by name.
    std::string options = refuses_warnings ? "-cl-std=CL1.2 -Werror" : "-cl-std=CL1.2 -w";
    options += fmt::format(" -cl-kernel-arg-info -DLOCAL_SIZE={}", form.local_size);
    if (!defines.contains("LANES")) options += fmt::format(" -DLANES={}", form.lanes);
    if (form.lanes == 1) options += " -DPORTABLE_LANES=1";  // nothing of the processor's own
    for (const auto& [name, value] : defines) options += fmt::format(" -D{}={}", name, value);
    return options;
}

cl::Program& Device::Context::build(const std::string& file, const std::string& options) {
    const std::string key = fmt::format("{} {}", file, options);
    const auto known = programs.find(key);
    if (known != programs.end()) return known->second;
    cl::Program program(context, assemble_source(file));
    try {
        program.build(device, options.c_str());
    } catch (const cl::Error& error) {
        throw RuntimeError("{} ({}, driver {}): cannot build {}: {}\noptions: {}\n{}", info.name,
                           info.platform, info.driver, file, describe(error), options,
                           program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device));
    }
    return programs.emplace(key, program).first->second;
}

void Kernel::Built::build() {
    if (!parameters.empty()) return;
    const auto start = Clock::now();
    try {
        kernel = cl::Kernel(context->build(file, options), name.c_str());
        const auto count = kernel.getInfo<CL_KERNEL_NUM_ARGS>();
        for (cl_uint i = 0; i < count; ++i) {
            parameters.push_back(
                {trimmed(kernel.getArgInfo<CL_KERNEL_ARG_NAME>(i)), type_of(kernel, i)});
        }
    } catch (const cl::Error& error) {
        throw RuntimeError("{}: {}: {}", context->info.name, name, describe(error));
    }
    context->compile_seconds += seconds_since(start);
}

Kernel Device::kernel(std::string_view file, const std::string& name, const Defines& defines,
                      const std::string& stage) {
    Kernel kernel;
    kernel.context_ = context_;
    kernel.built_ = std::make_shared<Kernel::Built>();
    Kernel::Built& built = *kernel.built_;
    built.context = context_.get();
    built.file = file;
    built.options = context_->options(defines);
    built.stage = stage;
    built.name = name;
    built.launched = {std::string(file), name, stage, defines};
    context_->waiting.push_back(kernel.built_);
    return kernel;
}

void Device::compile() {
    std::vector<std::shared_ptr<Kernel::Built>> kernels;
    for (const auto& kernel : std::exchange(context_->waiting, {}))
        if (kernel.use_count() > 1 && kernel->parameters.empty()) kernels.push_back(kernel);
    // Others than PoCL compile programs as they are built, and need not have a cache.
    if (context_->compilers && context_->info.platform == "Portable Computing Language") {
        const auto start = Clock::now();
        context_->compilers->compile(kernels);
        context_->compilers.reset();
        context_->compile_seconds += seconds_since(start);
    }
    for (const auto& kernel : kernels) kernel->build();
}

void Kernel::expect(std::size_t items) { built_->expected_items = items; }

void Kernel::launch(std::size_t items, const Arguments& arguments) {
    if (items == 0) return;
    Device::Context& context = *built_->context;
    built_->build();
    try {
        for (cl_uint i = 0; i < built_->parameters.size(); ++i) {
            const Built::Parameter& parameter = built_->parameters[i];
            const auto found = arguments.values_.find(parameter.name);
            if (found == arguments.values_.end())
                throw std::logic_error(
                    fmt::format("kernel {} needs an argument '{}'", built_->name, parameter.name));
            const auto& [content, type] = found->second;
            const auto* memory = std::get_if<DeviceMemory>(&content);
            if (!takes(parameter.type, *type, memory != nullptr))
                throw std::logic_error(fmt::format("kernel {}: argument '{}' is a {}, not {} {}",
                                                   built_->name, parameter.name, parameter.type,
                                                   memory != nullptr ? "a buffer of" : "a", *type));
            if (memory != nullptr) {
                if (!memory->allocation_)
                    throw std::logic_error(fmt::format("kernel {}: argument '{}' has no memory",
                                                       built_->name, parameter.name));
                built_->kernel.setArg(i, memory->allocation_->buffer);
            } else {
                const auto& bytes = std::get<std::vector<std::byte>>(content);
                built_->kernel.setArg(i, bytes.size(), bytes.data());
            }
        }
        const std::size_t local = context.form.local_size;
        const std::size_t global = (items + local - 1) / local * local;
        // Drivers compile at a kernel's first launch, PoCL once more for large ranges: what such a
        // launch takes beyond running counts as compiling.
        bool& compiled = built_->compiled[global < few_items];
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
