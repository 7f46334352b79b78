// SPDX-License-Identifier: MIT
#include "output/write_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstring>
#include <filesystem>

#include "error.hpp"
#include "signals.hpp"

namespace manylight {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t longest_stem = 200;  // bytes of a part's name: a name has 255 at most

// errno of what failed, or 0.
int write_all(int file, std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t written = write(file, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) return errno;
        bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
    return fsync(file) == 0 ? 0 : errno;
}

}  // namespace

void check_output(const std::string& option, const std::string& path,
                  std::span<const std::string> endings) {
    const fs::path target(path);
    std::string allowed;
    for (const std::string& ending : endings) allowed += (allowed.empty() ? "" : " or ") + ending;
    if (!endings.empty() &&
        std::ranges::find(endings, target.extension().string()) == endings.end())
        throw InputError("{} {}: the name must end in {}", option, path, allowed);
    const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
    std::error_code error;
    if (!fs::is_directory(folder, error))
        throw InputError("{} {}: there is no folder {}", option, path, folder.string());
    if (access(folder.c_str(), W_OK) != 0)
        throw InputError("{} {}: the folder {} cannot be written", option, path, folder.string());
    constexpr std::size_t aside = 32;  // by which the name of a part may be longer
    (void)fs::status(target, error);
    if (error == std::errc::filename_too_long || path.size() + aside >= PATH_MAX)
        throw InputError("{} {}: the name is too long", option, path);
    if (path.empty() || (fs::exists(target, error) && !fs::is_regular_file(target, error)))
        throw InputError("{} {}: is not a regular file", option, path);
}

bool same_file(const std::string& a, const std::string& b) {
    namespace fs = std::filesystem;
    std::error_code error;
    const auto canonical = [&](const std::string& path) {
        return fs::weakly_canonical(fs::absolute(path, error), error);
    };
    return !a.empty() && !b.empty() && canonical(a) == canonical(b);
}

void write_file(const std::string& path, std::span<const std::byte> bytes) {
    std::error_code error;
    const fs::path target =
        fs::is_symlink(path, error) ? fs::weakly_canonical(path, error) : fs::path(path);
    std::signal(SIGXFSZ, SIG_IGN);  // a file too large is an error as any other
    fs::path aside;
    int file = -1;
    // A process that was killed may have left its file, and this one may have its number.
    for (int i = 0; i < 100 && file < 0 && (i == 0 || errno == EEXIST); ++i) {
        aside = target.parent_path() /
                fmt::format(".{}.{}-{}.part", target.filename().string().substr(0, longest_stem),
                            getpid(), i);
        file = open(aside.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    }
    if (file < 0) throw RuntimeError("{}: cannot be written: {}", path, std::strerror(errno));
    remove_at_signal(aside.c_str());
    int problem = write_all(file, bytes);
    if (close(file) != 0 && problem == 0) problem = errno;
    if (problem == 0 && std::rename(aside.c_str(), target.c_str()) != 0) problem = errno;
    remove_at_signal(nullptr);
    if (problem == 0) return;
    unlink(aside.c_str());
    throw RuntimeError("{}: cannot be written: {}", path, std::strerror(problem));
}

}  // namespace manylight
