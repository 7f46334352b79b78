// SPDX-License-Identifier: MIT
// Compiling kernels on several processors at once: PoCL compiles one at a time in a process, so
// others fill its cache.
#include <fcntl.h>
#include <sched.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>

#include "device/context.hpp"
#include "device/kernel_sources.hpp"

namespace manylight {
namespace {

using nlohmann::json;

// An argument of 0. Its size is not to be had from OpenCL: the largest that the driver takes holds
// it, whether the driver looks at sizes or not.
void set_zero(cl::Kernel& kernel, cl_uint i) {
    constexpr std::array<std::byte, 256> zeros{};
    for (std::size_t bytes = zeros.size(); bytes > 0; bytes -= 4)
        if (clSetKernelArg(kernel(), i, bytes, zeros.data()) == CL_SUCCESS) return;
    throw cl::Error(CL_INVALID_ARG_SIZE, "clSetKernelArg");
}

// Compiles a program's kernels by launching them with nothing to do.
void compile_program(const cl::Context& context, const cl::Device& device, const json& job) {
    const cl::CommandQueue queue(context, device);
    const cl::Buffer zeros(context, CL_MEM_READ_WRITE, 4096);
    cl::Program program(context, assemble_source(job["file"].get<std::string>()));
    program.build(device, job["options"].get<std::string>().c_str());
    for (const json& wanted : job["kernels"]) {
        cl::Kernel kernel(program, wanted["name"].get<std::string>().c_str());
        const auto count = kernel.getInfo<CL_KERNEL_NUM_ARGS>();
        for (cl_uint i = 0; i < count; ++i)
            if (kernel.getArgInfo<CL_KERNEL_ARG_ADDRESS_QUALIFIER>(i) ==
                CL_KERNEL_ARG_ADDRESS_PRIVATE)
                set_zero(kernel, i);
            else
                kernel.setArg(i, zeros);
        queue.enqueueNDRangeKernel(kernel, cl::NullRange, wanted["items"].get<std::size_t>(),
                                   job["local_size"].get<std::size_t>());
        queue.finish();
    }
}

std::string read_all(int from) {
    std::string text;
    std::array<char, 4096> part;
    for (ssize_t count; (count = read(from, part.data(), part.size())) > 0;)
        text.append(part.data(), static_cast<std::size_t>(count));
    return text;
}

// What a helping process does: the programs that it is told to, on the device that it is told.
void help(int socket) {
    try {
        const json task = json::parse(read_all(socket));
        const cl::Device device = all_devices().at(task["device"].get<std::size_t>());
        const cl::Context context(device);
        for (const json& job : task["programs"]) compile_program(context, device, job);
    } catch (const std::exception&) {  // the kernel's own build will say what is wrong
    }
}

json programs_of(const std::vector<std::shared_ptr<Kernel::Built>>& kernels,
                 std::size_t local_size) {
    json programs = json::array();
    for (const auto& kernel : kernels) {
        auto found = std::ranges::find_if(programs, [&](const json& p) {
            return p["file"] == kernel->file && p["options"] == kernel->options;
        });
        if (found == programs.end()) {
            programs.push_back({{"file", kernel->file},
                                {"options", kernel->options},
                                {"local_size", local_size},
                                {"kernels", json::array()}});
            found = programs.end() - 1;
        }
        const std::size_t items =
            kernel->expected_items < few_items ? local_size : few_items / local_size * local_size;
        (*found)["kernels"].push_back({{"name", kernel->name}, {"items", items}});
    }
    return programs;
}

unsigned available_processors() {
    cpu_set_t allowed;
    return sched_getaffinity(0, sizeof(allowed), &allowed) == 0
               ? static_cast<unsigned>(CPU_COUNT(&allowed))
               : 1;
}

constexpr unsigned most_helpers = 7;

}  // namespace

Compilers::Compilers(unsigned threads) {
    const unsigned processors = threads > 0 ? threads : available_processors();
    for (unsigned i = 1; i < std::min(processors, most_helpers + 1); ++i) {
        int pair[2];
        if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0) return;
        const pid_t child = fork();
        if (child == 0) {
            for (const int other : sockets_) close(other);
            close(pair[0]);
            const int nowhere = open("/dev/null", O_RDWR);
            for (const int standard : {0, 1, 2}) dup2(nowhere, standard);
            help(pair[1]);
            _exit(0);
        }
        close(pair[1]);
        if (child < 0) {
            close(pair[0]);
            return;
        }
        sockets_.push_back(pair[0]);
    }
}

Compilers::~Compilers() {
    for (const int socket : sockets_) close(socket);
}

void Compilers::compile(const std::vector<std::shared_ptr<Kernel::Built>>& kernels) {
    if (kernels.empty()) return;
    const Device::Context& context = *kernels.front()->context;
    std::multimap<std::size_t, json, std::greater<>> programs;  // by the size of their sources
    for (const json& program : programs_of(kernels, context.form.local_size))
        programs.emplace(assemble_source(program["file"].get<std::string>()).size(), program);
    // The largest first, each to whom has least; the first share is this process's own.
    std::vector<std::pair<std::size_t, json>> shares(sockets_.size() + 1, {0, json::array()});
    for (const auto& [size, program] : programs) {
        auto& share = *std::ranges::min_element(
            shares, [](const auto& x, const auto& y) { return x.first < y.first; });
        share.first += size;
        share.second.push_back(program);
    }
    for (std::size_t i = 0; i < sockets_.size(); ++i) {
        const std::string task =
            json{{"device", context.number}, {"programs", shares[i + 1].second}}.dump();
        if (send(sockets_[i], task.data(), task.size(), MSG_NOSIGNAL) < 0) continue;
        shutdown(sockets_[i], SHUT_WR);
    }
    for (const json& program : shares[0].second) try {
            compile_program(context.context, context.device, program);
        } catch (const cl::Error&) {  // the kernel's own build will say what is wrong
        }
    for (const int socket : sockets_) {
        (void)read_all(socket);  // until the process has ended
        close(socket);
    }
    sockets_.clear();
}

}  // namespace manylight
