#pragma once
// What is wrong with a TOML document, collected with its places, so that a user mends several
// mistakes at once. A change from the command line is part of the document with "--set key=value"
// as its file name.

#include <toml++/toml.h>

#include <string>
#include <vector>

#include "taut/base/error.h"

namespace taut {

class Complaints {
 public:
  static constexpr std::size_t max_shown = 20;
  void add(const toml::source_region& where, const std::string& message);
  std::size_t size() const { return all_.size(); }
  // Throws InputError with a line for each complaint, in the order of the file, if there are any.
  void throw_if_any() const;

 private:
  struct Complaint {
    toml::source_position at;
    std::string text;
  };
  std::vector<Complaint> all_;
};

SourcePlace source_place(const toml::source_region& where);
// "FILE:LINE:COLUMN: message", or "--set key=value: message".
std::string located(const toml::source_region& where, const std::string& message);

// "the text \"5ms\"", "the integer 3", "an array of 2", ...
std::string found(const toml::node& value);

// "not valid TOML: ...": what TOML's parser says, and what to do about it.
std::string syntax_problem(const toml::parse_error& error);

}  // namespace taut
