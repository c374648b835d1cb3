// A client of HTTP and WebSocket for tests, written from RFC 7230 and RFC 6455: it shares no code with the server.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <regex>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace simvis::test {

/// How long anything may take on a busy machine.
inline constexpr int kPatience_ms = 60'000;

/// A TCP connection to this machine.
class Socket {
 public:
  explicit Socket(std::uint16_t port) : fd_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (fd_ >= 0 && ::connect(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return;
    close();
    throw std::runtime_error("cannot connect");
  }
  ~Socket() { close(); }
  Socket(Socket&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  Socket& operator=(Socket&&) = delete;

  void close() {
    if (fd_ >= 0) ::close(std::exchange(fd_, -1));
  }
  /// Ends the connection; a call of receive() on another thread then returns.
  void shut_down() { ::shutdown(fd_, SHUT_RDWR); }
  /// The other end reads an end behind what was sent.
  void finish_sending() { ::shutdown(fd_, SHUT_WR); }
  /// Returns false if the other end is gone.
  bool send(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t sent = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
    return true;
  }
  /// What has come; empty: the other end has closed the connection. Throws if nothing comes.
  std::string receive(int patience_ms = kPatience_ms) {
    pollfd waiting{fd_, POLLIN, 0};
    if (::poll(&waiting, 1, patience_ms) != 1) throw std::runtime_error("nothing came");
    char bytes[65536];
    const ssize_t size = ::recv(fd_, bytes, sizeof bytes, 0);
    return size <= 0 ? std::string() : std::string(bytes, static_cast<std::size_t>(size));
  }
  std::string receive_all(int patience_ms = kPatience_ms) {
    std::string all;
    for (std::string more; !(more = receive(patience_ms)).empty();) all += more;
    return all;
  }

 private:
  int fd_;
};

/// What a browser has of a page after it has opened the printed link.
struct OpenedPage {
  std::string folder;  ///< of its address: "/FOLDER"
  std::string cookie;  ///< "NAME=VALUE"
};

/// The pages of servers of this machine that http_get() and WebSocketClient take targets without a token as targets of,
/// by the server's port. Set before other threads connect.
inline std::map<std::uint16_t, OpenedPage>& opened_pages() {
  static std::map<std::uint16_t, OpenedPage> all;
  return all;
}
/// The target and Host of a request, with what a browser adds.
inline std::string request_head(std::uint16_t port, const std::string& target) {
  const auto page = opened_pages().find(port);
  const bool in_page = page != opened_pages().end() && target.find("token=") == target.npos;
  return (in_page ? page->second.folder : "") + target + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) +
         "\r\n" + (in_page ? "Cookie: " + page->second.cookie + "\r\n" : "");
}

struct HttpAnswer {
  int status = 0;
  std::string head, body;
};

/// Sends `request` as it is, and reads until the server closes the connection.
inline HttpAnswer http(std::uint16_t port, std::string_view request) {
  Socket socket(port);
  socket.send(request);
  const std::string all = socket.receive_all();
  HttpAnswer answer;
  const std::size_t end = all.find("\r\n\r\n");
  if (!all.starts_with("HTTP/1.1 ") || end == all.npos) return answer;
  answer.status = std::stoi(all.substr(9, 3));
  answer.head = all.substr(0, end + 2);
  answer.body = all.substr(end + 4);
  return answer;
}

inline HttpAnswer http_get(std::uint16_t port, const std::string& target, const std::string& more_headers = "") {
  return http(port, "GET " + request_head(port, target) + "Connection: close\r\n" + more_headers + "\r\n");
}

/// Opens the printed link as a browser does. The folder of the page is that of its cookie.
inline HttpAnswer open_link(std::uint16_t port, const std::string& token) {
  HttpAnswer answer = http_get(port, "/?token=" + token);
  std::smatch match;
  const std::regex cookie("Set-Cookie: (simvis_\\d+=\\w+); Path=(/\\w+)/; HttpOnly; SameSite=Strict\r\n");
  if (!std::regex_search(answer.head, match, cookie))
    throw std::runtime_error("the link sets no cookie: " + answer.head);
  opened_pages()[port] = {match[2], match[1]};
  return answer;
}

struct WebMessage {
  bool binary = false;
  std::string bytes;
};

class WebSocketClient {
 public:
  static std::string handshake(std::uint16_t port, const std::string& protocol, const std::string& target = "/live",
                               const std::string& more_headers = "") {
    return "GET " + request_head(port, target) +
           "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: "
           "dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: " +
           protocol + "\r\n" + more_headers + "\r\n";
  }

  WebSocketClient(std::uint16_t port, const std::string& protocol, const std::string& target = "/live",
                  const std::string& more_headers = "")
      : socket_(port) {
    socket_.send(handshake(port, protocol, target, more_headers));
    while (head_.find("\r\n\r\n") == head_.npos) {
      const std::string more = socket_.receive();
      if (more.empty()) break;
      head_ += more;
    }
    const std::size_t end = head_.find("\r\n\r\n");
    if (!head_.starts_with("HTTP/1.1 101 ") || end == head_.npos) throw std::runtime_error("refused: " + head_);
    bytes_ = head_.substr(end + 4);
    head_.resize(end + 2);
  }

  const std::string& head() const { return head_; }
  /// Whether it answers each frame of the page's protocol as a page does that has shown it.
  bool shows_frames = true;
  Socket& socket() { return socket_; }

  static std::string frame(std::string_view payload, std::uint8_t opcode, bool last = true) {
    constexpr std::string_view kMask = "\x12\x34\x56\x78";
    std::string frame(1, static_cast<char>((last ? 0x80 : 0) | opcode));
    if (payload.size() < 126) {
      frame += static_cast<char>(0x80 | payload.size());
    } else {
      const bool is_long = payload.size() > 0xffff;
      frame += static_cast<char>(0x80 | (is_long ? 127 : 126));
      for (int shift = is_long ? 56 : 8; shift >= 0; shift -= 8) frame += static_cast<char>(payload.size() >> shift);
    }
    frame += kMask;
    for (std::size_t i = 0; i < payload.size(); ++i) frame += static_cast<char>(payload[i] ^ kMask[i % 4]);
    return frame;
  }

  bool send(const nlohmann::json& message) { return socket_.send(frame(message.dump(), 1)); }
  bool send_text(std::string_view text) { return socket_.send(frame(text, 1)); }
  bool send_binary(std::string_view bytes) { return socket_.send(frame(bytes, 2)); }

  /// The next message; empty: the connection was closed. Throws if nothing comes.
  std::optional<WebMessage> receive(int patience_ms = kPatience_ms) {
    WebMessage message;
    for (;;) {
      const std::optional<std::string> head = take(2, patience_ms);
      if (!head) return std::nullopt;
      const auto opcode = static_cast<std::uint8_t>((*head)[0] & 0x0f);
      std::uint64_t size = static_cast<std::uint8_t>((*head)[1]) & 0x7f;
      if (size >= 126) {
        const std::optional<std::string> more = take(size == 126 ? 2 : 8, patience_ms);
        if (!more) return std::nullopt;
        size = 0;
        for (const char byte : *more) size = size << 8 | static_cast<std::uint8_t>(byte);
      }
      std::optional<std::string> payload = take(size, patience_ms);
      if (!payload) return std::nullopt;
      if (opcode == 9) socket_.send(frame(*payload, 10));
      if (opcode == 8) {
        close_reason_ = payload->size() > 2 ? payload->substr(2) : "";
        return std::nullopt;
      }
      if (opcode > 2) continue;
      if (opcode != 0) message.binary = opcode == 2;
      message.bytes += *payload;
      if (((*head)[0] & 0x80) == 0) continue;
      if (shows_frames && message.bytes.starts_with(R"({"op":"frame")")) send({{"op", "shown"}});
      return message;
    }
  }

  /// The next text message whose key "op" is `op`; others are skipped.
  nlohmann::json receive_op(const std::string& op) {
    return receive_until([&](const nlohmann::json& message) { return message.at("op") == op; });
  }
  template <typename Predicate>
  nlohmann::json receive_until(const Predicate& fits) {
    while (const std::optional<WebMessage> message = receive()) {
      if (message->binary) continue;
      nlohmann::json json = nlohmann::json::parse(message->bytes);
      if (fits(json)) return json;
    }
    throw std::runtime_error("the server has closed the connection: " + close_reason_);
  }
  /// The next binary message for which fits(bytes); others, and texts, are skipped.
  template <typename Predicate>
  std::string receive_binary(const Predicate& fits) {
    while (const std::optional<WebMessage> message = receive()) {
      if (message->binary && fits(message->bytes)) return message->bytes;
    }
    throw std::runtime_error("the server has closed the connection: " + close_reason_);
  }
  const std::string& close_reason() const { return close_reason_; }

 private:
  std::optional<std::string> take(std::uint64_t size, int patience_ms) {
    while (bytes_.size() < size) {
      const std::string more = socket_.receive(patience_ms);
      if (more.empty()) return std::nullopt;
      bytes_ += more;
    }
    std::string taken = bytes_.substr(0, size);
    bytes_.erase(0, size);
    return taken;
  }

  Socket socket_;
  std::string head_, bytes_, close_reason_;
};

}  // namespace simvis::test
