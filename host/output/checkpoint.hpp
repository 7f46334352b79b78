// SPDX-License-Identifier: MIT
// The state of a render between two pixel samples: what it takes to go on bit for bit.
#pragma once

#include <cstring>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "device/device.hpp"
#include "error.hpp"

namespace manylight {

/// Values by name.
class FrameState {
  public:
    template <class T>
    void put(const std::string& name, std::span<const T> values) {
        const auto bytes = std::as_bytes(values);
        sections_[name].assign(bytes.begin(), bytes.end());
    }
    template <class T>
    void put(const std::string& name, const T& value) {
        put(name, std::span<const T>(&value, 1));
    }
    template <class T>
    void put(const std::string& name, const Buffer<T>& buffer) {
        put(name, std::span<const T>(buffer.download()));
    }

    /// Throws InputError unless there are exactly `count` values of that name.
    template <class T>
    [[nodiscard]] std::vector<T> get(const std::string& name, std::size_t count) const {
        std::vector<T> values(count);
        const auto found = sections_.find(name);
        if (found == sections_.end() || found->second.size() != count * sizeof(T))
            throw InputError("the checkpoint's '{}' does not have {} values", name, count);
        std::memcpy(values.data(), found->second.data(), count * sizeof(T));
        return values;
    }
    template <class T>
    [[nodiscard]] T get(const std::string& name) const {
        return get<T>(name, 1)[0];
    }
    template <class T>
    void restore(const std::string& name, Buffer<T>& buffer) const {
        buffer.upload(std::span<const T>(get<T>(name, buffer.size())));
    }

    [[nodiscard]] const std::map<std::string, std::vector<std::byte>>& sections() const {
        return sections_;
    }
    [[nodiscard]] std::map<std::string, std::vector<std::byte>>& sections() { return sections_; }

  private:
    std::map<std::string, std::vector<std::byte>> sections_;
};

/// Where and how often a render is saved.
struct Saving {
    double seconds = 60;                          // between two times
    std::function<void(const FrameState&)> save;  // none: never
};

/// Writes a state as a file, the older one whole until then. `render` names what is rendered, with
/// everything that the image depends on.
void write_checkpoint(const std::string& path, const std::string& render, const FrameState& state);

struct Checkpoint {
    std::string render;
    FrameState state;
};

/// Throws InputError naming the file where it is not a whole checkpoint.
[[nodiscard]] Checkpoint read_checkpoint(const std::string& path);

}  // namespace manylight
