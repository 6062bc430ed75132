#pragma once
// HTTP by hand: what a browser would never send can be sent.

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <map>
#include <string>

namespace taut::test {

struct Reply {
  int status = 0;                              // 0: no reply
  std::map<std::string, std::string> headers;  // names in lower case
  std::string body;
};

// A connection to this address, or -1.
inline int connect_to(const std::string& address, int port, int patience_ms = 20000) {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  const timeval limit{patience_ms / 1000, patience_ms % 1000 * 1000};
  ::setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(port));
  ::inet_pton(AF_INET, address.c_str(), &to.sin_addr);
  if (::connect(socket, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0) return socket;
  ::close(socket);
  return -1;
}

inline Reply parse_reply(const std::string& bytes) {
  Reply reply;
  const std::size_t end = bytes.find("\r\n\r\n");
  if (!bytes.starts_with("HTTP/1.1 ") || end == std::string::npos) return reply;
  reply.status = std::stoi(bytes.substr(9, 3));
  for (std::size_t at = bytes.find("\r\n") + 2; at < end;) {
    const std::size_t line_end = bytes.find("\r\n", at), colon = bytes.find(": ", at);
    std::string name = bytes.substr(at, colon - at);
    for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    reply.headers[name] = bytes.substr(colon + 2, line_end - colon - 2);
    at = line_end + 2;
  }
  reply.body = bytes.substr(end + 4);
  return reply;
}

// Sends the bytes as they are; reads until the server closes, or says nothing for so long.
inline Reply send_raw(int port, const std::string& request, int patience_ms = 20000) {
  const int socket = connect_to("127.0.0.1", port, patience_ms);
  if (socket < 0) return {};
  (void)!::write(socket, request.data(), request.size());
  std::string bytes;
  char piece[65536];
  for (ssize_t n; (n = ::read(socket, piece, sizeof piece)) > 0;)
    bytes.append(piece, static_cast<std::size_t>(n));
  ::close(socket);
  return parse_reply(bytes);
}

inline std::string request_text(int port, const std::string& target,
                                const std::string& method = "GET") {
  return method + " " + target + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) +
         "\r\nConnection: close\r\n\r\n";
}

}  // namespace taut::test
