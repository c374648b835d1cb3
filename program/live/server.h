// The server of the live view: HTTP and WebSocket on one port, on a thread of its own.
//
// Limits   kServerLimits. A connection that breaks one is closed; the others do not notice.
// Access   every request needs the token in its target, or the page's folder in its path and the page's cookie, so that
//          another user or program of this machine has no access. "/" with the token sets the cookie and leads to the
//          page's folder. A request with the cookie must have the Origin of the page itself, one with the token may
//          have any. The Host must name this machine, so that a foreign name that resolves to it (DNS rebinding) is
//          refused.
// Shares   connections that have not shown the token yet have a limit of their own. Beyond it the oldest of them is
//          closed, so that half-open connections do not lock out others.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace simvis::live {

/// 128 random bits in hexadecimal. Throws MachineError.
std::string random_token();

struct ServerLimits {
  std::size_t connections = 64;  ///< that have shown the token
  std::size_t strangers = 32;    ///< that have not yet
  std::size_t header_bytes = 8192;
  std::size_t message_bytes = std::size_t{1} << 20;
  std::chrono::seconds request{10};   ///< for the header of a request, and for the WebSocket handshake
  std::chrono::seconds message{30};   ///< for one message of a client, from its first byte
  std::chrono::seconds idle{30};      ///< a client that answers no ping for so long is gone
  std::chrono::seconds response{60};  ///< for one message to a client, or one answer
};

/// The answer to a request.
struct Answer {
  unsigned status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::shared_ptr<const std::string> body;
  std::string policy = "default-src 'none'";  ///< of the page's content; no page may show it in a frame
};

/// A message to a client: `head` and `body`, one behind the other.
struct WireMessage {
  bool binary = false;
  std::string head;
  std::shared_ptr<const std::string> body;
};

/// The other end of one WebSocket, in the terms of its protocol. It makes a message when the connection can take one,
/// so that a slow client gets fewer messages.
class Peer {
 public:
  virtual ~Peer() = default;
  /// A message of the client. Throws InputError to close the connection, with its text as the reason.
  virtual void receive(std::string_view message, bool binary) = 0;
  /// The next message, if there is one. Throws InputError as receive().
  virtual std::optional<WireMessage> next() = 0;
};

/// What is served. All calls come on the server's thread.
class Service {
 public:
  virtual ~Service() = default;
  /// The answer for a path, which begins with "/" and is without the page's folder; empty: there is nothing. `query`
  /// follows "?", without the token.
  virtual std::optional<Answer> get(std::string_view path, std::string_view query) = 0;
  /// Names of the sub-protocols that connect() takes.
  virtual std::span<const std::string_view> protocols() const = 0;
  virtual std::unique_ptr<Peer> connect(std::string_view protocol) = 0;
};

struct ServerDesc {
  std::string address = "127.0.0.1";   ///< a numeric address
  std::uint16_t port = 0;              ///< 0: any free one
  std::string token = random_token();  ///< of the printed link
  ServerLimits limits{};
};

class Server {
 public:
  /// Listens from now on. `service` must outlive the server. Throws InputError: no such address; MachineError: the port
  /// is taken, or the system has no more sockets.
  Server(const ServerDesc& desc, Service& service);
  /// Closes all connections.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  std::uint16_t port() const;
  /// Runs `task` on the server's thread, and asks all peers for their next messages afterwards. Any thread.
  void post(std::function<void()> task);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace simvis::live
