// SPDX-License-Identifier: MIT
#include "chart/folder.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "error.hpp"

namespace manylight {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// "charts/" and a link to a folder mean the folder.
fs::path folder_of(const std::string& path) {
    std::error_code error;
    fs::path target = fs::weakly_canonical(fs::absolute(path, error), error);
    return target.has_filename() ? target : target.parent_path();
}

// What an older chart wrote, by its own list.
std::set<std::string> files_of_chart(const fs::path& folder) {
    std::ifstream file(folder / "chart.json");
    const json chart = json::parse(file, nullptr, false);
    std::set<std::string> names;
    if (!chart.is_object() || !chart.contains("files") || !chart["files"].is_array()) return names;
    for (const json& name : chart["files"])
        if (name.is_string()) names.insert(name.get<std::string>());
    return names;
}

// While it lives, the program cannot be interrupted, for the second that writing takes.
class Uninterrupted {
  public:
    Uninterrupted()
        : interrupt_(std::signal(SIGINT, SIG_IGN)), end_(std::signal(SIGTERM, SIG_IGN)) {}
    ~Uninterrupted() {
        (void)std::signal(SIGINT, interrupt_);
        (void)std::signal(SIGTERM, end_);
    }

  private:
    void (*interrupt_)(int);
    void (*end_)(int);
};

}  // namespace

void check_chart_folder(const std::string& option, const std::string& path) {
    const fs::path target = folder_of(path);
    const fs::path around = target.parent_path();
    std::error_code error;
    if (path.empty()) throw InputError("{}: the name is empty", option);
    (void)fs::status(path, error);
    if (error == std::errc::filename_too_long)
        throw InputError("{} {}: the name is too long", option, path);
    if (!fs::is_directory(around, error))
        throw InputError("{} {}: there is no folder {}", option, path, around.string());
    if (access(around.c_str(), W_OK) != 0)
        throw InputError("{} {}: the folder {} cannot be written", option, path, around.string());
    if (!fs::exists(target, error)) return;
    if (!fs::is_directory(target, error)) throw InputError("{} {}: is no folder", option, path);
    const std::set<std::string> known = files_of_chart(target);
    for (const auto& entry : fs::directory_iterator(target))
        if (!known.contains(entry.path().filename().string()))
            throw InputError("{} {}: holds {}, which is no part of a chart; name another folder",
                             option, path, entry.path().filename().string());
}

void write_chart_folder(const std::string& path,
                        const std::function<void(const std::string&)>& fill) {
    check_chart_folder("folder", path);  // again: much time may have gone by
    const Uninterrupted uninterrupted;
    const fs::path target = folder_of(path);
    const fs::path aside =
        target.parent_path() /
        fmt::format(".{}.{}.part", target.filename().string().substr(0, 200), getpid());
    std::error_code error;
    try {
        if (!fs::create_directory(aside, error))
            throw RuntimeError("{}: cannot be written: {}", path, error.message());
        fill(aside.string());
        const bool exists = fs::exists(target, error);
        const unsigned flags = exists ? RENAME_EXCHANGE : 0;
        if (renameat2(AT_FDCWD, aside.c_str(), AT_FDCWD, target.c_str(), flags) != 0)
            throw RuntimeError("{}: cannot be written: {}", path, std::strerror(errno));
    } catch (...) {
        fs::remove_all(aside, error);
        throw;
    }
    fs::remove_all(aside, error);  // the older chart
}

}  // namespace manylight
