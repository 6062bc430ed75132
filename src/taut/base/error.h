#pragma once
// Bad input (scene, mesh, matrix, checkpoint) is an InputError: its text names the place,
// what was found, what was expected and what to do. A numerical outcome is never an
// exception: see base/status.h.

#include <span>
#include <stdexcept>
#include <string>

namespace taut {

// Where in a file something is wrong. line and column count from 1; 0 means "not known".
struct SourcePlace {
  std::string file;
  int line = 0;
  int column = 0;
};

// "FILE:LINE:COLUMN: message", leaving out what is not known.
std::string located(const SourcePlace& place, const std::string& message);

class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message) : std::runtime_error(message) {}
  InputError(const SourcePlace& place, const std::string& message)
      : std::runtime_error(located(place, message)) {}
};

// The name in `known` closest to `word`, for "did you mean"; empty when nothing is near.
std::string nearest_name(const std::string& word, std::span<const std::string> known);

}  // namespace taut
