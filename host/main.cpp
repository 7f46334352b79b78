// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <exception>

#include "commands/commands.hpp"
#include "error.hpp"

int main(int argc, char** argv) {
    try {
        return manylight::run_program(argc, argv);
    } catch (const manylight::InputError& error) {
        fmt::print(stderr, "error: {}\n", error.what());
        return 2;
    } catch (const std::bad_alloc&) {
        fmt::print(stderr, "error: out of memory\n");
        return 1;
    } catch (const std::exception& error) {
        fmt::print(stderr, "error: {}\n", error.what());
        return 1;
    }
}
