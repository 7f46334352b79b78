// SPDX-License-Identifier: MIT
// OpenCL without its headers: pick a device, hold its memory, build and launch kernels, take times.
// Knows no stage.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <typeinfo>
#include <variant>
#include <vector>

namespace manylight {

struct DeviceInfo {
    std::string platform;
    std::string name;
    std::string version;   // of OpenCL
    std::string language;  // version of OpenCL C
    std::string driver;
    std::string type;  // CPU, GPU, accelerator or other
    bool is_gpu = false;
    unsigned compute_units = 0;
    std::uint64_t global_memory = 0;   // bytes
    std::uint64_t max_allocation = 0;  // bytes, of one buffer
    unsigned float_width = 1;          // native vector width, lanes
    bool usable = false;               // OpenCL 1.2, a compiler, little-endian, groups large enough
};

/// How kernels are laid out: the vectors that suit a device's registers, or, for GPUs, none.
struct DeviceForm {
    unsigned lanes;   // of a register, 16, 8, 4: rays go by 16 in vectors of these; 1: one by one
    unsigned pixels;  // that sampler adaptive draws together: 16, or 1
    unsigned bvh_width;   // children of a BVH node, and triangles of a block
    unsigned local_size;  // work-items of a group
};

/// What is publicly known to go wrong with a device's driver, in a sentence; empty: nothing.
[[nodiscard]] std::string known_trouble(const DeviceInfo& device);

/// The form of that many lanes; 1: what GPUs get, which other devices can run as well.
[[nodiscard]] DeviceForm form_of(unsigned lanes);

/// The form that suits a device.
[[nodiscard]] DeviceForm form_for(const DeviceInfo& device);

/// Every OpenCL device of every platform, in the loader's order.
[[nodiscard]] std::vector<DeviceInfo> list_devices();

/// The position in list_devices() that `selector` means: a number, its whole name, or part of the
/// name or version of its platform, or else of its own name, in any case; empty: a GPU if there is
/// one, otherwise PoCL, otherwise the first. Throws InputError if that is no usable device or more
/// than one.
[[nodiscard]] std::size_t select_device(std::string_view selector);

/// Bytes of buffers that count for one purpose (see Counting).
struct MemoryUse {
    std::size_t live = 0;  // now
    std::size_t most = 0;  // at any one time
};

/// Bytes on a device; copies share them. Freed with the last copy.
class DeviceMemory {
  public:
    DeviceMemory() = default;
    [[nodiscard]] std::size_t bytes() const;
    void write(const void* source, std::size_t bytes, std::size_t offset);
    void read(void* destination, std::size_t bytes, std::size_t offset) const;
    void clear();  // to zero bytes

  private:
    friend class Device;
    friend class Kernel;
    struct Allocation;
    std::shared_ptr<Allocation> allocation_;
};

/// An array of T on a device.
template <class T>
class Buffer : public DeviceMemory {
    static_assert(std::is_trivially_copyable_v<T>);

  public:
    Buffer() = default;
    explicit Buffer(DeviceMemory memory) : DeviceMemory(std::move(memory)) {}
    [[nodiscard]] std::size_t size() const { return bytes() / sizeof(T); }
    void upload(std::span<const T> values, std::size_t first = 0) {
        write(values.data(), values.size_bytes(), first * sizeof(T));
    }
    [[nodiscard]] std::vector<T> download(std::size_t first, std::size_t count) const {
        std::vector<T> values(count);
        read(values.data(), count * sizeof(T), first * sizeof(T));
        return values;
    }
    [[nodiscard]] std::vector<T> download() const { return download(0, size()); }

    /// The same bytes as an array of another type.
    template <class U>
    [[nodiscard]] Buffer<U> as() const {
        return Buffer<U>(static_cast<const DeviceMemory&>(*this));
    }
};

/// What OpenCL C calls a type of the host: "float", "uint", "float4", "Tiles", ...
[[nodiscard]] std::string opencl_name(const std::type_info& type);

/// Kernel arguments by the names that the kernel gives them, with their types; a kernel takes those
/// that it has.
class Arguments {
  public:
    template <class T>
    Arguments& set(std::string name, const Buffer<T>& buffer) {
        return put(std::move(name), buffer, name_of<T>());
    }
    template <class T>
    requires std::is_trivially_copyable_v<T> Arguments& set(std::string name, const T& value) {
        const auto* bytes = reinterpret_cast<const std::byte*>(&value);
        return put(std::move(name), std::vector(bytes, bytes + sizeof(T)), name_of<T>());
    }
    /// Takes over all of `other`.
    Arguments& set(const Arguments& other) {
        for (const auto& [name, value] : other.values_) values_[name] = value;
        return *this;
    }

    /// What the buffer of that name holds; nothing where there is none.
    template <class T>
    [[nodiscard]] std::vector<T> download(const std::string& name) const {
        const auto found = values_.find(name);
        if (found == values_.end()) return {};
        return Buffer<T>(std::get<DeviceMemory>(found->second.content)).download();
    }

  private:
    friend class Kernel;
    using Content = std::variant<DeviceMemory, std::vector<std::byte>>;
    struct Value {
        Content content;
        const std::string* type;  // in OpenCL C; of a buffer, of its elements
    };

    Arguments& put(std::string name, Content content, const std::string& type);

    template <class T>
    static const std::string& name_of() {
        static const std::string name = opencl_name(typeid(T));
        return name;
    }

    std::map<std::string, Value> values_;
};

/// Integers that a kernel is compiled with (-D).
using Defines = std::map<std::string, int>;

/// A kernel that was launched, and how it was built.
struct Launched {
    std::string file;  // below kernels/
    std::string kernel;
    std::string stage;
    Defines defines;
    auto operator<=>(const Launched&) const = default;
};

/// A kernel of a built program; copies share it.
class Kernel {
  public:
    /// Runs at least `items` work-items (a whole number of groups), in order with what was
    /// launched before, without waiting. Throws std::logic_error if the kernel has a parameter
    /// that `arguments` does not name or give the type of (of buffers: vectors and the numbers that
    /// they are of are alike), RuntimeError if the device refuses.
    void launch(std::size_t items, const Arguments& arguments);

    /// Tells Device::compile() how many work-items launches will have at most: PoCL compiles a
    /// kernel for many work-items apart from one for few.
    void expect(std::size_t items);

    struct Built;

  private:
    friend class Device;
    std::shared_ptr<void> context_;  // the device's, which the kernel keeps
    std::shared_ptr<Built> built_;
};

/// Processes that help Device::compile() once. PoCL compiles one kernel at a time in a process;
/// what others compile, it finds in its cache.
class Compilers {
  public:
    /// Starts them, before anything touches OpenCL: as many as there are processors, or `threads`,
    /// less one. Where the system allows none, there are none.
    explicit Compilers(unsigned threads);
    ~Compilers();
    Compilers(const Compilers&) = delete;
    Compilers& operator=(const Compilers&) = delete;

    /// Compiles kernels of one device into PoCL's cache. What fails is left to fail when it is
    /// built.
    void compile(const std::vector<std::shared_ptr<Kernel::Built>>& kernels);

  private:
    std::vector<int> sockets_;
};

/// One OpenCL device with a queue. Copies share it.
class Device {
  public:
    /// Opens a device (see select_device). `threads` > 0: on a CPU, use that many; to be called
    /// before anything else touches OpenCL. `lanes` > 0: in another form than suits it. Throws
    /// InputError, RuntimeError.
    [[nodiscard]] static Device open(std::string_view selector, unsigned threads = 0,
                                     unsigned lanes = 0);

    [[nodiscard]] const DeviceInfo& info() const;

    [[nodiscard]] const DeviceForm& form() const;

    /// From now on a compiler's warning fails a build; for tests. Users' builds take all of them.
    void refuse_warnings();

    /// An array of `count` elements of undefined value. Throws RuntimeError if it does not fit.
    template <class T>
    [[nodiscard]] Buffer<T> allocate(std::size_t count) {
        return Buffer<T>(allocate_bytes(count * sizeof(T)));
    }
    template <class T>
    [[nodiscard]] Buffer<T> upload(std::span<const T> values) {
        Buffer<T> buffer = allocate<T>(values.size());
        buffer.upload(values);
        return buffer;
    }
    template <class T>
    [[nodiscard]] Buffer<T> upload(const std::vector<T>& values) {
        return upload(std::span<const T>(values));
    }

    /// The same without a copy where the device works on the host's memory: `values` live longer,
    /// are not changed and aligned as kernels take them to be. Kernels only read it.
    template <class T, class Allocator>
    [[nodiscard]] Buffer<T> share(const std::vector<T, Allocator>& values) {
        if (info().is_gpu) return upload(std::span<const T>(values));
        return Buffer<T>(allocate_bytes(values.size() * sizeof(T), values.data()));
    }

    /// A kernel of kernels/`file`, to be built with `defines` for this device at its first launch,
    /// or by compile(); its times count for `stage`. Programs are built once. A build that fails
    /// throws RuntimeError with the device, its driver, options and log.
    [[nodiscard]] Kernel kernel(std::string_view file, const std::string& name,
                                const Defines& defines, const std::string& stage);

    /// Builds all kernels that were asked for and not launched yet; with helpers, which serve once,
    /// PoCL's on several processors. Kernels find nothing to do where all their arguments are 0.
    void compile();
    void help(std::shared_ptr<Compilers> compilers);

    /// Waits until all that was launched is done.
    void finish();

    /// Largest number of bytes allocated at any one time.
    [[nodiscard]] std::size_t peak_bytes() const;

    /// Seconds that kernels ran on the device, by stage. Waits.
    [[nodiscard]] std::map<std::string, double> stage_seconds();

    /// Seconds spent on compiling kernels, those of their first launch included.
    [[nodiscard]] double compile_seconds() const;

    /// The kernels that were launched for the first time since the last call.
    [[nodiscard]] std::set<Launched> take_launched();

    struct Context;  // OpenCL's objects

  private:
    friend class Counting;
    [[nodiscard]] DeviceMemory allocate_bytes(std::size_t bytes, const void* shared = nullptr);
    std::shared_ptr<Context> context_;
};

/// As long as it lives, what its device allocates counts for `use`, and for nothing else.
class Counting {
  public:
    Counting(const Device& device, std::shared_ptr<MemoryUse> use);
    ~Counting();
    Counting(const Counting&) = delete;
    Counting& operator=(const Counting&) = delete;

  private:
    std::shared_ptr<Device::Context> context_;
    std::shared_ptr<MemoryUse> before_;
};

}  // namespace manylight
