// SPDX-License-Identifier: MIT
#include "signals.hpp"

#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <initializer_list>

namespace manylight {
namespace {

char path_to_remove[4096];
volatile std::sig_atomic_t has_path = 0;
volatile std::sig_atomic_t keeps = 0;
volatile std::sig_atomic_t pending = 0;

void raise_by_default(int number) {
    std::signal(number, SIG_DFL);
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, number);
    sigprocmask(SIG_UNBLOCK, &set, nullptr);
    std::raise(number);
}

void handle(int number) {
    if (keeps != 0 && pending == 0 && number != SIGHUP) {
        pending = number;
        return;
    }
    if (has_path != 0) unlink(path_to_remove);
    raise_by_default(number);
}

void handle_signals() {
    static const bool once = [] {
        for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
            struct sigaction action {};
            sigaction(number, nullptr, &action);
            if (action.sa_handler == SIG_IGN) continue;
            action = {};
            action.sa_handler = handle;
            action.sa_flags = SA_RESTART;  // a driver's own calls go on
            sigaction(number, &action, nullptr);
        }
        return true;
    }();
    (void)once;
}

}  // namespace

KeptSignals::KeptSignals() {
    handle_signals();
    keeps = 1;
}

KeptSignals::~KeptSignals() { keeps = 0; }

int pending_signal() { return pending; }

void end_by(int signal_number) {
    std::fflush(nullptr);
    raise_by_default(signal_number);
    std::_Exit(128 + signal_number);
}

void remove_at_signal(const char* path) {
    has_path = 0;
    handle_signals();
    if (path == nullptr || std::strlen(path) >= sizeof(path_to_remove)) return;
    std::strcpy(path_to_remove, path);
    has_path = 1;
}

}  // namespace manylight
