// A page of the live view without a browser: it reads all that comes.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <string_view>

namespace simvis {

/// The token of the servers that a LiveViewer reads.
inline constexpr const char* kLiveToken = "benchmark";

/// A connection to a server of this machine, which answers each frame at once. It ends with an exception
/// when the server closes it.
class LiveViewer {
 public:
  explicit LiveViewer(std::uint16_t port, bool web_socket = true) : port_(port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (::connect(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) fail();
    if (!web_socket) return;
    send_bytes(head("/live") +
               "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: "
               "dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: simvis.live.v1\r\n\r\n");
    while (bytes_.find("\r\n\r\n") == bytes_.npos) read_some();
    bytes_.erase(0, bytes_.find("\r\n\r\n") + 4);
  }
  ~LiveViewer() { ::close(fd_); }
  LiveViewer(const LiveViewer&) = delete;
  LiveViewer& operator=(const LiveViewer&) = delete;

  /// Ends a receive() on another thread.
  void shut_down() { ::shutdown(fd_, SHUT_RDWR); }

  void send(const nlohmann::json& message) {
    const std::string text = message.dump();
    std::string frame = "\x81";
    if (text.size() < 126) {
      frame += static_cast<char>(0x80 | text.size());
    } else {
      frame += "\xfe";
      frame += static_cast<char>(text.size() >> 8);
      frame += static_cast<char>(text.size());
    }
    send_bytes(frame + std::string(4, '\0') + text);  // a mask of zeros
  }

  struct Message {
    bool binary;
    std::string bytes;
  };
  Message receive() {
    Message message{false, ""};
    for (;;) {
      const std::string first = take(2);
      std::uint64_t size = static_cast<std::uint8_t>(first[1]);
      if (size >= 126) {
        const std::string more = take(size == 126 ? 2 : 8);
        size = 0;
        for (const char byte : more) size = size << 8 | static_cast<std::uint8_t>(byte);
      }
      const std::string payload = take(size);
      const int opcode = first[0] & 0x0f;  // 0: the message goes on
      if (opcode > 2) continue;
      if (opcode != 0) message.binary = opcode == 2;
      message.bytes += payload;
      if ((first[0] & 0x80) == 0) continue;
      if (message.bytes.starts_with(R"({"op":"frame")")) send({{"op", "shown"}});
      return message;
    }
  }
  nlohmann::json receive_op(const std::string& op) {
    for (;;) {
      const Message message = receive();
      if (message.binary) continue;
      nlohmann::json json = nlohmann::json::parse(message.bytes);
      if (json.at("op") == op) return json;
    }
  }

  /// The size of what is at this address, head included, once all of it has come; an exception if the server refuses
  /// it. On a connection of its own.
  std::size_t get(const std::string& target) {
    send_bytes(head(target) + "Connection: close\r\n\r\n");
    try {
      for (;;) read_some();
    } catch (const std::runtime_error&) {  // the end
    }
    if (!bytes_.starts_with("HTTP/1.1 200 ")) throw std::runtime_error("the server refuses " + target);
    return bytes_.size();
  }

 private:
  [[noreturn]] static void fail() { throw std::runtime_error("the connection has ended"); }
  std::string head(const std::string& target) const {
    const char* const separator = target.find('?') == target.npos ? "?" : "&";
    return "GET " + target + separator + "token=" + kLiveToken +
           " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port_) + "\r\n";
  }
  void send_bytes(const std::string& bytes) {
    if (::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(bytes.size())) fail();
  }
  void read_some() {
    char bytes[65536];
    const ssize_t size = ::recv(fd_, bytes, sizeof bytes, 0);
    if (size <= 0) fail();
    bytes_.append(bytes, static_cast<std::size_t>(size));
  }
  std::string take(std::uint64_t size) {
    while (bytes_.size() < size) read_some();
    std::string taken = bytes_.substr(0, size);
    bytes_.erase(0, size);
    return taken;
  }

  int fd_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  std::uint16_t port_;
  std::string bytes_;
};

}  // namespace simvis
