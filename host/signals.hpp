// SPDX-License-Identifier: MIT
// What SIGINT, SIGTERM and SIGHUP do: end the program, at once or when its work so far is kept.
#pragma once

namespace manylight {

/// While it lives, the first SIGINT or SIGTERM is kept for pending_signal(); a second one ends the
/// program at once. A signal that the program was started to ignore stays ignored.
class KeptSignals {
  public:
    KeptSignals();
    ~KeptSignals();
    KeptSignals(const KeptSignals&) = delete;
    KeptSignals& operator=(const KeptSignals&) = delete;
};

/// The signal that was kept, also after that; 0: none came.
[[nodiscard]] int pending_signal();

/// Ends the program by a signal, so that a shell's loop ends too.
[[noreturn]] void end_by(int signal_number);

/// The file that goes with the program where a signal ends it; null: none. The path is copied; one
/// that is longer than paths can be is none.
void remove_at_signal(const char* path);

}  // namespace manylight
