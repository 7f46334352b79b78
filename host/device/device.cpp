// SPDX-License-Identifier: MIT
#include "device/device.hpp"

#include <sched.h>

#include <cstdlib>
#include <map>
#include <utility>

#include "device/context.hpp"
#include "error.hpp"

namespace manylight {
namespace {

// Lets the process, and so a CPU driver's threads, run on the first `threads` processors it has.
void limit_threads(unsigned threads) {
    cpu_set_t allowed;
    cpu_set_t kept;
    CPU_ZERO(&kept);
    if (sched_getaffinity(0, sizeof(allowed), &allowed) != 0) return;
    unsigned left = threads;
    for (int cpu = 0; cpu < CPU_SETSIZE && left > 0; ++cpu)
        if (CPU_ISSET(cpu, &allowed)) {
            CPU_SET(cpu, &kept);
            --left;
        }
    if (left > 0)
        throw InputError("--threads {}: only {} processors are available", threads, threads - left);
    sched_setaffinity(0, sizeof(kept), &kept);
    // PoCL starts a thread per processor of the machine, whatever the affinity.
    setenv("POCL_MAX_PTHREAD_COUNT", std::to_string(threads).c_str(), 1);
}

}  // namespace

std::string describe(const cl::Error& error) {
    const std::map<cl_int, const char*> words = {
        {CL_DEVICE_NOT_AVAILABLE, "device not available"},
        {CL_COMPILER_NOT_AVAILABLE, "no compiler"},
        {CL_MEM_OBJECT_ALLOCATION_FAILURE, "out of device memory"},
        {CL_OUT_OF_RESOURCES, "out of resources"},
        {CL_OUT_OF_HOST_MEMORY, "out of host memory"},
        {CL_BUILD_PROGRAM_FAILURE, "build failure"},
        {CL_INVALID_BUFFER_SIZE, "buffer too large"},
        {CL_INVALID_WORK_GROUP_SIZE, "work-group too large"},
        {CL_INVALID_ARG_SIZE, "argument of the wrong size"},
    };
    const auto known = words.find(error.err());
    return fmt::format("{} failed: {} (OpenCL error {})", error.what(),
                       known == words.end() ? "see the OpenCL headers" : known->second,
                       error.err());
}

DeviceMemory::Allocation::~Allocation() {
    context->allocated -= bytes;
    if (use) use->live -= bytes;
}

std::size_t DeviceMemory::bytes() const { return allocation_ ? allocation_->bytes : 0; }

void DeviceMemory::write(const void* source, std::size_t bytes, std::size_t offset) {
    if (bytes == 0) return;
    try {
        allocation_->context->queue.enqueueWriteBuffer(allocation_->buffer, CL_TRUE, offset, bytes,
                                                       source);
    } catch (const cl::Error& error) {
        throw RuntimeError("{}: {}", allocation_->context->info.name, describe(error));
    }
}

void DeviceMemory::read(void* destination, std::size_t bytes, std::size_t offset) const {
    if (bytes == 0) return;
    try {
        allocation_->context->queue.enqueueReadBuffer(allocation_->buffer, CL_TRUE, offset, bytes,
                                                      destination);
    } catch (const cl::Error& error) {
        throw RuntimeError("{}: {}", allocation_->context->info.name, describe(error));
    }
}

void DeviceMemory::clear() {
    if (bytes() == 0) return;
    try {
        allocation_->context->queue.enqueueFillBuffer(allocation_->buffer, cl_uchar{0}, 0,
                                                      allocation_->bytes);
    } catch (const cl::Error& error) {
        throw RuntimeError("{}: {}", allocation_->context->info.name, describe(error));
    }
}

Device Device::open(std::string_view selector, unsigned threads, unsigned lanes) {
    if (threads > 0) limit_threads(threads);
    const std::size_t index = select_device(selector);
    Device device;
    device.context_ = std::make_shared<Context>();
    Context& context = *device.context_;
    context.info = list_devices()[index];
    context.number = index;
    context.form = lanes > 0 ? form_of(lanes) : form_for(context.info);
    try {
        context.device = all_devices()[index];
        context.context = cl::Context(context.device);
        context.queue =
            cl::CommandQueue(context.context, context.device, CL_QUEUE_PROFILING_ENABLE);
    } catch (const cl::Error& error) {
        throw RuntimeError("{}: {}", context.info.name, describe(error));
    }
    return device;
}

const DeviceInfo& Device::info() const { return context_->info; }

const DeviceForm& Device::form() const { return context_->form; }

void Device::help(std::shared_ptr<Compilers> compilers) {
    context_->compilers = std::move(compilers);
}

void Device::refuse_warnings() { context_->refuses_warnings = true; }

// `shared`: the values, which stay where they are.
DeviceMemory Device::allocate_bytes(std::size_t bytes, const void* shared) {
    DeviceMemory memory;
    memory.allocation_ = std::make_shared<DeviceMemory::Allocation>();
    DeviceMemory::Allocation& allocation = *memory.allocation_;
    allocation.context = context_;
    try {
        if (shared != nullptr && bytes > 0)
            allocation.buffer =
                cl::Buffer(context_->context, CL_MEM_READ_ONLY | CL_MEM_USE_HOST_PTR, bytes,
                           const_cast<void*>(shared));
        else  // OpenCL has no empty buffers
            allocation.buffer = cl::Buffer(context_->context, CL_MEM_READ_WRITE,
                                           std::max<std::size_t>(bytes, sizeof(cl_float16)));
    } catch (const cl::Error& error) {
        throw RuntimeError("{}: cannot allocate {} bytes: {}", context_->info.name, bytes,
                           describe(error));
    }
    allocation.bytes = bytes;
    context_->allocated += bytes;
    context_->peak = std::max(context_->peak, context_->allocated);
    if (context_->use) {
        allocation.use = context_->use;
        allocation.use->live += bytes;
        allocation.use->most = std::max(allocation.use->most, allocation.use->live);
    }
    return memory;
}

Counting::Counting(const Device& device, std::shared_ptr<MemoryUse> use)
    : context_(device.context_), before_(std::exchange(context_->use, std::move(use))) {}

Counting::~Counting() { context_->use = std::move(before_); }

void Device::finish() { context_->collect(); }

std::size_t Device::peak_bytes() const { return context_->peak; }

std::set<Launched> Device::take_launched() { return std::exchange(context_->launched, {}); }

double Device::compile_seconds() const { return context_->compile_seconds; }

std::map<std::string, double> Device::stage_seconds() {
    context_->collect();
    return context_->stage_seconds;
}

void Device::Context::collect() {
    try {
        queue.finish();
        for (const auto& [stage, event] : running) {
            const auto start = event.getProfilingInfo<CL_PROFILING_COMMAND_START>();
            const auto end = event.getProfilingInfo<CL_PROFILING_COMMAND_END>();
            stage_seconds[stage] += static_cast<double>(end - start) * 1e-9;
        }
    } catch (const cl::Error& error) {
        running.clear();
        throw RuntimeError("{}: {}", info.name, describe(error));
    }
    running.clear();
}

}  // namespace manylight
