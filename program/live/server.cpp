// Boost's templates are kept in this file: it takes long to compile.
#include "program/live/server.h"

#include <sys/random.h>

#include <array>
#include <boost/asio/bind_executor.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <cerrno>
#include <new>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include <simvis/error.h>
#include "engine/base/assert.h"
#include "engine/base/low_priority.h"
#include "program/live/access.h"

namespace simvis::live {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using Tcp = asio::ip::tcp;
using ErrorCode = beast::error_code;

std::string_view view_of(beast::string_view text) { return {text.data(), text.size()}; }

}  // namespace

/// What connections share. All but post() and the constructor is of the server's thread.
class Server::Impl {
 public:
  Impl(const ServerDesc& desc, Service& service)
      : desc_(desc),
        service_(service),
        rules_{.address = desc.address,
               .port = desc.port,
               .token = desc.token,
               .page = random_token(),
               .cookie = random_token()},
        context_(1),
        acceptor_(context_) {
    SIMVIS_ASSERT(!desc.token.empty());
    listen();
    thread_ = std::thread([this] {
      lower_thread_priority();
      serve();
    });
  }
  ~Impl() {
    asio::post(context_, [this] { close(); });
    thread_.join();
  }

  class Connection;

  std::uint16_t port() const { return port_; }
  void post(std::function<void()> task) {
    asio::post(context_, [this, task = std::move(task)] {
      try {
        task();
      } catch (const Error&) {  // the simulation goes on without the message
      } catch (const std::bad_alloc&) {
      }
      pump();
    });
  }

  const ServerLimits& limits() const { return desc_.limits; }
  Service& service() { return service_; }
  const AccessRules& rules() const { return rules_; }
  void forget(Connection* connection) {
    connections_.erase(connection);
    std::erase(strangers_, connection);
  }
  /// The connection has shown the token. Returns false if there are too many such connections.
  bool admit(Connection* connection) {
    if (std::erase(strangers_, connection) == 0) return true;  // it was admitted before
    return connections_.size() - strangers_.size() <= desc_.limits.connections;
  }

 private:
  void listen() {
    ErrorCode error;
    const asio::ip::address address = asio::ip::make_address(desc_.address, error);
    if (error) throw InputError(desc_.address + " is no numeric address of a network");
    const Tcp::endpoint endpoint(address, desc_.port);
    const auto check = [&](const ErrorCode& failed) {
      if (!failed) return;
      throw MachineError("cannot listen at " + desc_.address + " port " + std::to_string(desc_.port) + ": " +
                         failed.message());
    };
    acceptor_.open(endpoint.protocol(), error);
    check(error);
    acceptor_.set_option(asio::socket_base::reuse_address(true), error);
    check(error);
    acceptor_.bind(endpoint, error);
    check(error);
    acceptor_.listen(asio::socket_base::max_listen_connections, error);
    check(error);
    port_ = acceptor_.local_endpoint(error).port();
    check(error);
    rules_.port = port_;
  }
  void serve();
  void accept();
  void close_oldest_stranger();
  void pump();
  void close();

  ServerDesc desc_;
  Service& service_;
  AccessRules rules_;
  asio::io_context context_;
  Tcp::acceptor acceptor_;
  asio::steady_timer accept_pause_{context_};
  std::uint16_t port_ = 0;
  bool accepts_ = false, closed_ = false;
  std::set<Connection*> connections_;   // each is alive as long as it is here
  std::vector<Connection*> strangers_;  // those of them that have not shown the token, oldest first
  std::thread thread_;
};

/// One connection: first of HTTP, perhaps of a WebSocket later.
class Server::Impl::Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Impl& server, Tcp::socket socket)
      : server_(server), stream_(std::move(socket)), deadline_(stream_.get_executor()) {}
  ~Connection() { server_.forget(this); }

  void read_request() {
    parser_.emplace();
    parser_->header_limit(static_cast<std::uint32_t>(server_.limits().header_bytes));
    parser_->body_limit(0);
    stream_.expires_after(server_.limits().request);
    http::async_read(stream_, buffer_, *parser_,
                     [self = shared_from_this()](ErrorCode error, std::size_t) { self->on_request(error); });
  }

  /// Sends what the peer has, if the connection can take it.
  void pump() {
    if (!socket_ || writes_ || ending_) return;
    try {
      std::optional<WireMessage> message = peer_->next();
      if (message) write(std::move(*message));
    } catch (const Error& error) {
      end(websocket::close_code::policy_error, error.what());
    }
  }

  void close() {
    ending_ = true;
    deadline_.cancel();
    ErrorCode ignored;
    Tcp::socket& socket = socket_ ? beast::get_lowest_layer(*socket_).socket() : stream_.socket();
    socket.shutdown(Tcp::socket::shutdown_both, ignored);
    socket.close(ignored);
  }

  /// Ends the connection since the server ends.
  void take_leave() {
    if (!socket_) return close();
    leaves_ = true;
    if (peer_) return end(websocket::close_code::going_away, "the simulation has ended");
    expect(std::chrono::seconds(2));  // the handshake is under way
  }

 private:
  using Socket = websocket::stream<beast::tcp_stream>;

  void on_request(ErrorCode error) {
    if (error == http::error::end_of_stream) return shut_down();
    if (error == http::error::header_limit) return refuse(431, "the header is too long");
    if (error == http::error::body_limit) return refuse(413, "a request has no body here");
    if (error) {
      // A request that is no HTTP is answered, one that did not arrive is not.
      if (error.category() == http::make_error_code(http::error::bad_method).category()) {
        refuse(400, "this is no request of HTTP");
      }
      return;
    }
    request_ = parser_->release();
    const auto origin = request_.find(http::field::origin);
    const bool has_origin = origin != request_.end();
    const RequestFacts facts{.target = view_of(request_.target()),
                             .host = view_of(request_[http::field::host]),
                             .origin = has_origin ? view_of(origin->value()) : std::string_view(),
                             .has_origin = has_origin,
                             .cookie = view_of(request_[http::field::cookie])};
    if (request_.count(http::field::host) != 1 || request_.count(http::field::origin) > 1) {
      return refuse(400, "expected one Host and at most one Origin");
    }
    const Admission admitted = admission(facts, server_.rules());
    if (!admitted.refusal.empty()) return refuse(403, admitted.refusal);
    if (!server_.admit(this)) return refuse(503, "the server has too many connections");
    if (websocket::is_upgrade(request_)) return upgrade();
    if (request_.method() != http::verb::get && request_.method() != http::verb::head) {
      return refuse(405, "expected GET or HEAD");
    }
    if (admitted.by_token && admitted.path == "/") return enter();
    std::optional<Answer> answer;
    try {
      answer = server_.service().get(admitted.path, admitted.query);
    } catch (const Error& error) {
      return refuse(500, error.what());
    }
    if (!answer) return refuse(404, "there is nothing at this address");
    respond(std::move(*answer), request_.keep_alive());
  }

  void enter() {
    const std::string nonce = random_token();
    Answer answer;
    answer.type = "text/html; charset=utf-8";
    answer.body = std::make_shared<const std::string>(entry_page(server_.rules(), nonce));
    answer.policy = "default-src 'none'; script-src 'nonce-" + nonce + "'";
    cookie_ = page_cookie(server_.rules());
    respond(std::move(answer), request_.keep_alive());
  }

  void refuse(unsigned status, std::string why) {
    Answer answer;
    answer.status = status;
    answer.body = std::make_shared<const std::string>(std::move(why) + "\n");
    respond(std::move(answer), false);
  }

  using Body = http::span_body<const char>;
  void respond(Answer answer, bool keep_alive) {
    answer_ = std::move(answer);
    response_.emplace(static_cast<http::status>(answer_.status), request_.version() == 10 ? 10 : 11);
    response_->set(http::field::content_type, answer_.type);
    response_->set(http::field::cache_control, "no-store");
    // The address of the page has a secret.
    response_->set("Referrer-Policy", "no-referrer");
    response_->set("X-Content-Type-Options", "nosniff");
    response_->set("Cross-Origin-Resource-Policy", "same-origin");
    // A page of others that shows this one in a frame could lead its user's clicks.
    response_->set("Content-Security-Policy", answer_.policy + "; frame-ancestors 'none'");
    if (!cookie_.empty()) response_->set(http::field::set_cookie, std::exchange(cookie_, {}));
    response_->keep_alive(keep_alive);
    const std::size_t size = answer_.body->size();
    if (request_.method() != http::verb::head) response_->body() = {answer_.body->data(), size};
    response_->content_length(size);
    stream_.expires_after(server_.limits().response);
    http::async_write(stream_, *response_, [self = shared_from_this(), keep_alive](ErrorCode error, std::size_t) {
      self->response_.reset();
      self->answer_ = {};
      if (error) return;
      if (!keep_alive) return self->shut_down();
      self->read_request();
    });
  }

  // What the client is still sending is read for a moment: closing the socket over it would discard the answer.
  void shut_down() {
    ErrorCode ignored;
    stream_.socket().shutdown(Tcp::socket::shutdown_send, ignored);
    stream_.expires_after(std::chrono::seconds(1));
    drain();
  }
  void drain() {
    stream_.async_read_some(asio::buffer(drained_), [self = shared_from_this()](ErrorCode error, std::size_t size) {
      constexpr std::size_t kMost = std::size_t{1} << 16;
      self->drained_bytes_ += size;
      if (!error && self->drained_bytes_ < kMost) self->drain();
    });
  }

  std::optional<std::string_view> chosen_protocol() const {
    const http::token_list offered(request_[http::field::sec_websocket_protocol]);
    for (const auto& name : offered) {
      for (const std::string_view known : server_.service().protocols()) {
        if (view_of(name) == known) return known;
      }
    }
    return std::nullopt;
  }

  void upgrade() {
    const std::optional<std::string_view> protocol = chosen_protocol();
    if (!protocol) {
      std::string known;
      for (const std::string_view name : server_.service().protocols())
        known += (known.empty() ? "" : ", ") + std::string(name);
      return refuse(400, "the WebSocket has no sub-protocol of this server, expected one of " + known);
    }
    stream_.expires_never();
    socket_.emplace(std::move(stream_));
    websocket::stream_base::timeout timeout{};
    timeout.handshake_timeout = server_.limits().request;
    timeout.idle_timeout = server_.limits().idle;
    timeout.keep_alive_pings = true;
    socket_->set_option(timeout);
    socket_->read_message_max(server_.limits().message_bytes);
    socket_->auto_fragment(false);  // a message is one frame, sent from where it lies
    socket_->set_option(websocket::stream_base::decorator([protocol = *protocol](websocket::response_type& response) {
      response.set(http::field::sec_websocket_protocol, beast::string_view(protocol.data(), protocol.size()));
    }));
    writes_ = true;
    socket_->async_accept(request_, [self = shared_from_this(), protocol = *protocol](ErrorCode error) {
      self->writes_ = false;
      if (error || self->ending_) return;
      self->peer_ = self->server_.service().connect(protocol);
      if (self->leaves_) return self->take_leave();
      self->buffer_.clear();
      self->read_message();
      self->pump();
    });
  }

  void read_message() {
    socket_->async_read_some(buffer_, 0,
                             [self = shared_from_this()](ErrorCode error, std::size_t) { self->on_read(error); });
  }

  // A message comes in pieces; the clock runs from its first to its last one.
  void on_read(ErrorCode error) {
    if (error || ending_) return close();
    if (!socket_->is_message_done()) {
      if (!in_message_) expect(server_.limits().message);
      in_message_ = true;
      return read_message();
    }
    if (in_message_) deadline_.cancel();
    in_message_ = false;
    try {
      const beast::flat_buffer::const_buffers_type bytes = buffer_.data();
      peer_->receive({static_cast<const char*>(bytes.data()), bytes.size()}, socket_->got_binary());
    } catch (const Error& refused) {
      return end(websocket::close_code::policy_error, refused.what());
    }
    buffer_.clear();
    read_message();
    pump();
  }

  void write(WireMessage message) {
    writes_ = true;
    writing_ = std::move(message);
    static const std::string kNothing;
    const std::string& body = writing_.body ? *writing_.body : kNothing;
    const std::array<asio::const_buffer, 2> buffers{asio::buffer(writing_.head), asio::buffer(body)};
    socket_->binary(writing_.binary);
    write_deadline_.expires_after(server_.limits().response);
    write_deadline_.async_wait([weak = weak_from_this()](ErrorCode error) {
      if (const auto self = weak.lock(); !error && self) self->close();
    });
    socket_->async_write(buffers, [self = shared_from_this()](ErrorCode error, std::size_t) {
      self->write_deadline_.cancel();
      self->writes_ = false;
      self->writing_ = {};
      if (error) return self->close();
      self->pump();
    });
  }

  void expect(std::chrono::seconds time) {
    deadline_.expires_after(time);
    deadline_.async_wait([weak = weak_from_this()](ErrorCode error) {
      if (const auto self = weak.lock(); !error && self) self->close();
    });
  }

  void end(websocket::close_code code, std::string_view why) {
    if (ending_) return;
    ending_ = true;
    websocket::close_reason reason(code);
    reason.reason = beast::string_view(why.data(), std::min<std::size_t>(why.size(), 120));
    expect(std::chrono::seconds(2));
    socket_->async_close(reason, [self = shared_from_this()](ErrorCode) { self->close(); });
  }

  Impl& server_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::empty_body>> parser_;
  http::request<http::empty_body> request_;
  Answer answer_;
  std::string cookie_;  // that the answer sets; empty: none
  std::optional<http::response<Body>> response_;
  std::array<char, 1024> drained_{};
  std::size_t drained_bytes_ = 0;
  std::optional<Socket> socket_;
  std::unique_ptr<Peer> peer_;
  WireMessage writing_;
  asio::steady_timer deadline_, write_deadline_{deadline_.get_executor()};
  bool writes_ = false, in_message_ = false, ending_ = false, leaves_ = false;
};

// Where there is no memory for what a connection asks for, that connection ends, and the others go on.
void Server::Impl::serve() {
  while (true) {
    try {
      if (!accepts_ && !closed_) accept();
      return static_cast<void>(context_.run());
    } catch (const std::bad_alloc&) {
    }
  }
}

void Server::Impl::accept() {
  acceptor_.async_accept([this](ErrorCode error, Tcp::socket socket) {
    accepts_ = false;
    if (closed_) return;
    if (error) {
      // Out of files: they come back when connections end.
      accept_pause_.expires_after(std::chrono::milliseconds(100));
      accept_pause_.async_wait([this](ErrorCode stopped) {
        if (!stopped && !closed_ && !accepts_) accept();
      });
      return;
    }
    if (strangers_.size() >= desc_.limits.strangers) close_oldest_stranger();
    ErrorCode ignored;
    socket.set_option(Tcp::no_delay(true), ignored);
    const auto connection = std::make_shared<Connection>(*this, std::move(socket));
    connections_.insert(connection.get());
    strangers_.push_back(connection.get());
    connection->read_request();
    accept();
  });
  accepts_ = true;
}

// A client that has the token sends its request at once, so it is rarely the oldest.
void Server::Impl::close_oldest_stranger() {
  const std::shared_ptr<Connection> oldest = strangers_.front()->shared_from_this();
  strangers_.erase(strangers_.begin());
  oldest->close();
}

void Server::Impl::pump() {
  std::vector<std::shared_ptr<Connection>> all;
  for (Connection* const each : connections_) all.push_back(each->shared_from_this());
  for (const std::shared_ptr<Connection>& each : all) each->pump();
}

void Server::Impl::close() {
  closed_ = true;
  ErrorCode ignored;
  acceptor_.close(ignored);
  accept_pause_.cancel();
  std::vector<std::shared_ptr<Connection>> all;
  for (Connection* const each : connections_) all.push_back(each->shared_from_this());
  for (const std::shared_ptr<Connection>& each : all) each->take_leave();
}

Server::Server(const ServerDesc& desc, Service& service) : impl_(std::make_unique<Impl>(desc, service)) {}
Server::~Server() = default;
std::uint16_t Server::port() const { return impl_->port(); }
void Server::post(std::function<void()> task) { impl_->post(std::move(task)); }

std::string random_token() {
  std::array<unsigned char, 16> bits{};
  if (::getrandom(bits.data(), bits.size(), 0) != static_cast<ssize_t>(bits.size())) {
    throw MachineError("the system gives no random numbers for a token");
  }
  constexpr char kDigits[] = "0123456789abcdef";
  std::string token;
  for (const unsigned char byte : bits) {
    token += kDigits[byte / 16];
    token += kDigits[byte % 16];
  }
  return token;
}

}  // namespace simvis::live
