#pragma once
// "1 cloth", "3 cloths".

#include <fmt/format.h>

namespace taut::app {

template <class Count>
std::string counted(Count n, const char* thing) {
  return fmt::format("{} {}{}", n, thing, n == Count{1} ? "" : "s");
}

}  // namespace taut::app
