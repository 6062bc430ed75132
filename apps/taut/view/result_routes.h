#pragma once
// What the viewer's page may ask of a results folder: see view_server.h. Several threads may call
// one object.

#include <functional>
#include <map>
#include <mutex>
#include <string>

#include "view/run_state.h"

namespace taut::app {

// `length` bytes; read gives up to `most` of them from `offset`, at least one, or throws.
struct Answer {
  std::size_t length = 0;
  std::string type;
  std::function<std::string(std::size_t offset, std::size_t most)> read;
  std::map<std::string, std::string> headers;
};

// What was asked cannot be answered; the status is that of HTTP.
struct Refusal {
  int status = 404;
  std::string message;
};

using Parameters = std::multimap<std::string, std::string>;

class ResultRoutes {
 public:
  explicit ResultRoutes(ResultFiles files) : files_(std::move(files)), state_(files_) {}
  ResultRoutes(const ResultRoutes&) = delete;
  ResultRoutes& operator=(const ResultRoutes&) = delete;
  // Throws Refusal, or InputError when a file is damaged.
  Answer answer(const std::string& name, const Parameters& parameters);

 private:
  Answer state();
  Answer array(const std::string& file, const char* type, int row) const;
  Answer frames(const Parameters& parameters, bool contact) const;
  Answer stats(const Parameters& parameters) const;

  ResultFiles files_;
  std::mutex state_mutex_;
  RunStateReader state_;
};

// An answer that is all there.
Answer whole_answer(std::string content, std::string type);

}  // namespace taut::app
