#include "view/view_server.h"

#include <fmt/format.h>
#include <httplib.h>

#include <chrono>
#include <random>
#include <thread>

#include "taut/base/error.h"
#include "view/result_routes.h"

namespace taut::app {

namespace {

constexpr std::size_t piece_bytes = std::size_t{1} << 20;

constexpr const char* content_policy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; font-src "
    "'self'; connect-src 'self'; worker-src "
    "'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

std::string random_key() {
  std::random_device source;
  std::string key;
  for (int n = 0; n < 4; ++n) key += fmt::format("{:08x}", source());
  return key;
}

// The library's own choice adds SO_REUSEPORT: another process could take a share of the port.
void reuse_address_only(socket_t socket) {
  const int yes = 1;
  ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
}

// Sent piece by piece with its length told before: what has a length is not compressed either,
// which over loopback would only cost time.
void send(httplib::Response& response, Answer answer) {
  for (const auto& [name, value] : answer.headers) response.set_header(name, value);
  response.status = 200;
  if (answer.length == 0) return response.set_content("", answer.type);
  response.set_content_provider(
      answer.length, answer.type,
      [read = std::move(answer.read)](std::size_t offset, std::size_t length,
                                      httplib::DataSink& sink) {
        try {
          const std::string piece = read(offset, std::min(length, piece_bytes));
          return !piece.empty() && sink.write(piece.data(), piece.size());
        } catch (...) {
          // too late for another status: the connection breaks off, and
          // the page asks again
          return false;
        }
      });
}

void refuse(httplib::Response& response, int status, const std::string& message) {
  response.status = status;
  response.set_content(nlohmann::json{{"error", message}}.dump(
                           -1, ' ', false, nlohmann::json::error_handler_t::replace) +
                           "\n",
                       "application/json");
}

}  // namespace

struct ViewServer::Parts {
  Parts(ResultFiles files, PageFiles page_files)
      : routes(std::move(files)), page(std::move(page_files)), key(random_key()) {}
  void answer(const httplib::Request& request, httplib::Response& response);
  void answer_path(const std::string& path, const httplib::Request& request,
                   httplib::Response& response);
  bool is_own_host(const std::string& host) const {
    return host == fmt::format("127.0.0.1:{}", port) || host == fmt::format("localhost:{}", port);
  }

  ResultRoutes routes;
  PageFiles page;
  std::string key;
  int port = 0;
  httplib::Server server;
};

void ViewServer::Parts::answer(const httplib::Request& request, httplib::Response& response) {
  if (request.get_header_value_count("Host") != 1 || !is_own_host(request.get_header_value("Host")))
    return refuse(response, 403, "this server answers to 127.0.0.1 only");
  if (request.method != "GET" && request.method != "HEAD") {
    response.set_header("Allow", "GET, HEAD");
    return refuse(response, 405, "this server only shows");
  }
  // The target as it came, before anything was decoded: our own names need no escapes.
  const std::string& target = request.target;
  const std::string path = target.substr(0, target.find('?')), prefix = "/" + key + "/";
  if (target.find('%') != std::string::npos || path.find("..") != std::string::npos ||
      path.find('\\') != std::string::npos)
    return refuse(response, 400, "this is no address of the viewer's");
  if (!path.starts_with(prefix))
    return refuse(response, 404, "open the whole address that `taut view` printed");
  answer_path(path.substr(prefix.size()), request, response);
}

void ViewServer::Parts::answer_path(const std::string& path, const httplib::Request& request,
                                    httplib::Response& response) try {
  if (path.starts_with("api/"))
    return send(response,
                routes.answer(path.substr(4), {request.params.begin(), request.params.end()}));
  const auto file = page.find(path.empty() ? "index.html" : path);
  if (file == page.end()) return refuse(response, 404, "there is nothing of this name");
  // The page outlives all requests: server and page go together.
  const PageFile& found = file->second;
  send(response, {found.content.size(),
                  found.type,
                  [&found](std::size_t offset, std::size_t most) {
                    return found.content.substr(offset, most);
                  },
                  {}});
} catch (const Refusal& refusal) {
  refuse(response, refusal.status, refusal.message);
} catch (const std::exception& error) {
  refuse(response, 500, error.what());
}

ViewServer::ViewServer(ResultFiles files, PageFiles page, int port)
    : parts_(std::make_unique<Parts>(std::move(files), std::move(page))) {
  httplib::Server& server = parts_->server;
  server.set_socket_options(reuse_address_only);
  server.set_tcp_nodelay(true);
  server.set_payload_max_length(1024);
  server.set_keep_alive_max_count(10'000);
  server.set_keep_alive_timeout(10);
  // A browser keeps six connections a tab.
  server.new_task_queue = [] { return new httplib::ThreadPool(32); };
  server.set_default_headers({{"Content-Security-Policy", content_policy},
                              {"X-Content-Type-Options", "nosniff"},
                              {"Referrer-Policy", "no-referrer"},
                              {"Cross-Origin-Resource-Policy", "same-origin"},
                              {"Cross-Origin-Opener-Policy", "same-origin"},
                              {"Cache-Control", "no-store"}});
  server.set_pre_routing_handler(
      [this](const httplib::Request& request, httplib::Response& response) {
        parts_->answer(request, response);
        return httplib::Server::HandlerResponse::Handled;
      });
  const int bound = port == 0 ? server.bind_to_any_port("127.0.0.1")
                              : (server.bind_to_port("127.0.0.1", port) ? port : -1);
  if (bound <= 0)
    throw InputError(
        port == 0
            ? "no port of 127.0.0.1 can be had"
            : fmt::format("port {} of 127.0.0.1 cannot be had; leave --port out to get a free one",
                          port));
  parts_->port = bound;
}

ViewServer::~ViewServer() = default;
std::string ViewServer::address() const {
  return fmt::format("http://127.0.0.1:{}/{}/", parts_->port, parts_->key);
}
void ViewServer::run() { parts_->server.listen_after_bind(); }
void ViewServer::stop() {
  // A server that does not listen yet would not hear it.
  for (int tries = 0; tries < 1000 && !parts_->server.is_running(); ++tries)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  parts_->server.stop();
}

}  // namespace taut::app
