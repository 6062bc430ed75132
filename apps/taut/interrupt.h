#pragma once
// Ctrl-C asks politely: the first one stops after the current step, with everything so far written;
// the second ends the program at once.

#include <atomic>

namespace taut::app {

// Installs the handler for SIGINT and SIGTERM; the flag becomes true at the first signal.
const std::atomic<bool>& interrupt_flag();

}  // namespace taut::app
