// SPDX-License-Identifier: MIT
#include <cstdio>
#include <exception>

#include "commands/commands.hpp"
#include "error.hpp"
#include "print.hpp"

namespace {

// A compiler's log has lines; all that names what a user gave is one.
int fail(const char* message, int status, bool lines) {
    const std::string text = "error: " + manylight::escaped(message, lines) + "\n";
    std::fwrite(text.data(), 1, text.size(), stderr);
    return status;
}

int run(int argc, char** argv) {
    try {
        return manylight::run_program(argc, argv);
    } catch (const manylight::InputError& error) {
        return fail(error.what(), 2, false);
    } catch (const std::bad_alloc&) {
        return fail("out of memory", 1, false);
    } catch (const std::exception& error) {
        return fail(error.what(), 1, true);
    }
}

}  // namespace

int main(int argc, char** argv) {
    std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);  // a log shows each line as it comes
    const int status = run(argc, argv);
    if (!manylight::standard_output_fails() || status != 0) return status;
    return fail("standard output cannot be written", 1, false);
}
