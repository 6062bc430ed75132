#pragma once
// Opens an address in the user's browser, where there is a screen to open it on.

#include <string>

namespace taut::app {

// False when there is no screen, or no program that opens addresses. Does not wait for the browser.
bool open_browser(const std::string& address);

}  // namespace taut::app
