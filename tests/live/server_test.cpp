// The server of the live view: access, limits, hostile peers.
#include <doctest/doctest.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <filesystem>
#include <memory>
#include <random>
#include <thread>

#include <simvis/error.h>
#include "program/live/access.h"
#include "program/live/server.h"
#include "tests/live/web_client.h"

TEST_SUITE_BEGIN("live");

namespace simvis::live {
namespace {

using test::http;
using test::http_get;
using test::Socket;
using test::WebSocketClient;

/// Sends each message back.
class Echo : public Peer {
 public:
  explicit Echo(std::atomic<int>& alive) : alive_(alive) { ++alive_; }
  ~Echo() override { --alive_; }
  void receive(std::string_view message, bool binary) override {
    if (message == "bad") throw InputError("a bad message");
    waiting_.push_back({binary, std::string(message), nullptr});
  }
  std::optional<WireMessage> next() override {
    if (waiting_.empty()) return std::nullopt;
    WireMessage message = std::move(waiting_.front());
    waiting_.erase(waiting_.begin());
    return message;
  }

 private:
  std::atomic<int>& alive_;
  std::vector<WireMessage> waiting_;
};

class EchoService : public Service {
 public:
  std::optional<Answer> get(std::string_view path, std::string_view query) override {
    if (path != "/page") return std::nullopt;
    return Answer{200, "text/html", std::make_shared<const std::string>("page " + std::string(query))};
  }
  std::span<const std::string_view> protocols() const override {
    static constexpr std::string_view kNames[] = {"echo.v1", "echo.v2"};
    return kNames;
  }
  std::unique_ptr<Peer> connect(std::string_view) override { return std::make_unique<Echo>(alive); }
  std::atomic<int> alive = 0;
};

std::size_t open_files() {
  std::size_t count = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) ++count;
  return count;
}

/// Waits until all clients are gone.
void wait_for_none(const EchoService& service) {
  for (int i = 0; i < test::kPatience_ms / 10 && service.alive > 0; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  CHECK(service.alive == 0);
}

struct Echoing {
  explicit Echoing(ServerLimits limits = {})
      : server({.token = "secret", .limits = limits}, service),
        port(server.port()),
        host("Host: 127.0.0.1:" + std::to_string(port) + "\r\n") {
    test::open_link(port, "secret");
  }
  /// The status of a request with these headers.
  int status(const std::string& target, const std::string& headers) {
    return http(port, "GET " + target + " HTTP/1.1\r\nConnection: close\r\n" + headers + "\r\n").status;
  }
  /// The server still works.
  void check_alive() {
    WebSocketClient client(port, "echo.v1");
    client.send_text("still there");
    CHECK(client.receive()->bytes == "still there");
  }
  EchoService service;
  Server server;
  std::uint16_t port;
  std::string host;
};

}  // namespace

TEST_CASE("pages are answered, and what is no page is refused") {
  Echoing echoing;
  const std::uint16_t port = echoing.port;
  CHECK(http_get(port, "/page?a=1&token=secret&b=2").body == "page a=1&b=2");
  CHECK(http_get(port, "/page").head.find("Content-Type: text/html\r\n") != std::string::npos);
  CHECK(http_get(port, "/page").head.find("Referrer-Policy: no-referrer\r\n") != std::string::npos);
  CHECK(http_get(port, "/page").head.find("Content-Security-Policy: default-src 'none'; frame-ancestors 'none'\r\n") !=
        std::string::npos);
  CHECK(http_get(port, "/page").head.find("Cache-Control: no-store\r\n") != std::string::npos);
  CHECK(http_get(port, "/page").head.find("X-Content-Type-Options: nosniff\r\n") != std::string::npos);
  CHECK(http_get(port, "/page").head.find("Cross-Origin-Resource-Policy: same-origin\r\n") != std::string::npos);
  CHECK(http_get(port, "/other").status == 404);
  CHECK(http_get(port, "/../page").status == 404);
  const test::HttpAnswer head =
      http(port, "HEAD /page?token=secret HTTP/1.1\r\n" + echoing.host + "Connection: close\r\n\r\n");
  CHECK(head.status == 200);
  CHECK(head.body.empty());
  CHECK(http(port, "POST /page?token=secret HTTP/1.1\r\n" + echoing.host + "Content-Length: 0\r\n\r\n").status == 405);
  CHECK(
      http(port, "POST /page?token=secret HTTP/1.1\r\n" + echoing.host + "Content-Length: 9\r\n\r\n123456789").status ==
      413);
  CHECK(http(port, "GET /page?token=secret HTTP/1.1\r\n" + echoing.host + echoing.host + "\r\n").status == 400);
  CHECK(http(port, "nonsense\r\n\r\n").status == 400);
  CHECK(http(port, "GET /page HTTP/1.1\r\nX: " + std::string(10'000, 'x') + "\r\n\r\n").status == 431);
  echoing.check_alive();
  ServerLimits limits;
  limits.header_bytes = 1000;
  Echoing strict(limits);
  const std::string more = "X: " + std::string(2000, 'x') + "\r\n";
  CHECK(strict.status("/page?token=secret", strict.host + more) == 431);
  CHECK(echoing.status("/page?token=secret", echoing.host + more) == 200);
}

TEST_CASE("without the token nothing is answered, to no Host and no Origin") {
  Echoing echoing;
  const std::string port = std::to_string(echoing.port);
  const std::string own = "Origin: http://127.0.0.1:" + port + "\r\n", foreign = "Origin: https://foreign.example\r\n";
  for (const char* const path : {"/page", "/other", "/", "/scene.glb?structure=1"}) {
    CHECK_MESSAGE(echoing.status(path, echoing.host) == 403, path);
    CHECK_MESSAGE(echoing.status(path, echoing.host + own) == 403, path);
  }
  CHECK(echoing.status("/page", "Host: localhost:" + port + "\r\n") == 403);
  CHECK(echoing.status("/page?token=", echoing.host) == 403);
  CHECK(echoing.status("/page?token=Secret", echoing.host) == 403);
  CHECK(echoing.status("/page?token=secretsecret", echoing.host) == 403);
  CHECK(echoing.status("/page", echoing.host + "Cookie: simvis_" + port + "=wrong\r\n") == 403);
  test::opened_pages().erase(echoing.port);
  CHECK_THROWS(WebSocketClient(echoing.port, "echo.v1"));
  CHECK_THROWS(WebSocketClient(echoing.port, "echo.v1", "/live", own));
  CHECK_NOTHROW(WebSocketClient(echoing.port, "echo.v1", "/live?x=1&token=secret"));
}

TEST_CASE("a token in the target admits any Origin") {
  Echoing echoing;
  const std::string port = std::to_string(echoing.port);
  const std::string foreign = "Origin: https://foreign.example\r\n";
  CHECK(echoing.status("/page?token=secret", echoing.host) == 200);
  CHECK(echoing.status("/page?token=secret", echoing.host + foreign) == 200);
  CHECK_NOTHROW(WebSocketClient(echoing.port, "echo.v1", "/live?token=secret", foreign));
  CHECK(echoing.status("/page?token=secret", "Host: localhost:" + port + "\r\n") == 200);
  CHECK(echoing.status("/page?token=secret", "Host: 127.0.0.1\r\n") == 200);  // through a tunnel the port is another
  CHECK(echoing.status("/page?token=secret", "Host: rebinding.example:" + port + "\r\n") == 403);
  CHECK(echoing.status("/page?token=secret", "Host: 127.0.0.1.example\r\n") == 403);
  CHECK(echoing.status("/page?token=secret", "") == 400);
}

TEST_CASE("the printed link sets a cookie and leads to a page, whose secrets are neither the token nor each other's") {
  Echoing echoing;
  const test::HttpAnswer entry = test::open_link(echoing.port, "secret");
  const test::OpenedPage page = test::opened_pages()[echoing.port];
  const std::string name = "simvis_" + std::to_string(echoing.port) + "=";
  CHECK(page.folder.size() == 33);
  CHECK(page.cookie.size() == name.size() + 32);
  CHECK(page.cookie.substr(name.size()) != page.folder.substr(1));
  CHECK(entry.body.find("location.replace(\"" + page.folder + "/\" + location.hash)") != std::string::npos);
  CHECK(entry.body.find("secret") == std::string::npos);
  CHECK(entry.head.find("script-src 'nonce-") != std::string::npos);
  CHECK(http_get(echoing.port, "/page").head.find("Set-Cookie") == std::string::npos);
  CHECK(http_get(echoing.port, "/page?token=secret").head.find("Set-Cookie") == std::string::npos);
  Echoing other;
  const test::OpenedPage others = test::opened_pages()[other.port];
  CHECK(others.folder != page.folder);
  CHECK(others.cookie.substr(others.cookie.find('=')) != page.cookie.substr(page.cookie.find('=')));
}

TEST_CASE("a cookie admits the own page in its folder alone") {
  Echoing echoing;
  const std::string port = std::to_string(echoing.port);
  const std::string own = "Origin: http://127.0.0.1:" + port + "\r\n", foreign = "Origin: https://foreign.example\r\n";
  const test::OpenedPage opened = test::opened_pages()[echoing.port];
  const std::string page = opened.folder + "/page", cookie = "Cookie: a=b; " + opened.cookie + "\r\n";
  CHECK(echoing.status(page, echoing.host + cookie) == 200);
  CHECK(echoing.status(page, echoing.host + cookie + own) == 200);
  CHECK(echoing.status(page, echoing.host + cookie + foreign) == 403);
  CHECK(echoing.status(page, echoing.host + cookie + "Origin: http://127.0.0.1:1\r\n") == 403);
  CHECK(echoing.status(page, echoing.host + cookie + "Origin: https://127.0.0.1:" + port + "\r\n") == 403);
  CHECK(echoing.status(page, echoing.host + cookie + "Origin: null\r\n") == 403);
  CHECK(echoing.status(page, echoing.host + cookie + own + own) == 400);
  CHECK(echoing.status(page, "Host: rebinding.example:" + port + "\r\n" + cookie) == 403);
  CHECK_THROWS(WebSocketClient(echoing.port, "echo.v1", "/live", foreign));
  CHECK_NOTHROW(WebSocketClient(echoing.port, "echo.v1", "/live", own));
  // Servers at other ports may set cookies of this name for all folders.
  const std::string planted = "simvis_" + port + "=planted; ";
  CHECK(echoing.status(page, echoing.host + "Cookie: " + planted + opened.cookie + "\r\n") == 200);
  // One secret is not enough, and its answer does not say which is right.
  const auto answer = [&](const std::string& target, const std::string& cookies) {
    const test::HttpAnswer got = http(echoing.port, "GET " + target + " HTTP/1.1\r\nConnection: close\r\n" +
                                                        echoing.host + cookies + foreign + "\r\n");
    return std::to_string(got.status) + got.body;
  };
  const std::string nothing = answer("/page", "");
  CHECK(nothing.starts_with("403"));
  CHECK(answer(page, "") == nothing);
  CHECK(answer("/page", cookie) == nothing);
  CHECK(answer(opened.folder, cookie) == nothing);
  CHECK(answer("/" + std::string(32, '0') + "/page", cookie) == nothing);
  CHECK(answer(page, "Cookie: " + planted + "\r\n") == nothing);
  CHECK(answer(page, "Cookie: simvis_" + port + "=secret\r\n") == nothing);  // the token is no cookie
  CHECK(answer(page, "Cookie: simvis_1" + opened.cookie.substr(opened.cookie.find('=')) + "\r\n") == nothing);
  CHECK(answer("/page?token=" + opened.folder.substr(1), "") == nothing);
  CHECK(answer("/page?token=" + opened.cookie.substr(opened.cookie.find('=') + 1), "") == nothing);
}

TEST_CASE("a Host is this machine by any numeric address, as localhost, and by its own names") {
  const auto answered = [](const std::string& host) {
    const AccessRules rules{.address = "127.0.0.1", .token = "secret", .page = "page", .cookie = "cookie"};
    return admission({.target = "/page?token=secret", .host = host, .origin = "", .has_origin = false}, rules)
        .refusal.empty();
  };
  std::array<char, 256> name{};
  REQUIRE(::gethostname(name.data(), name.size() - 1) == 0);
  const std::string own = name.data();
  CHECK(answered("192.168.7.8:80"));
  CHECK(answered("[::1]:80"));
  CHECK(answered("localhost"));
  CHECK(answered(own + ":80"));
  CHECK(answered(own + ".local"));
  CHECK_FALSE(answered(own + ".example"));
  CHECK_FALSE(answered(""));
}

TEST_CASE("half-open connections lock out neither others nor each other") {
  ServerLimits limits;
  limits.strangers = 8;
  Echoing echoing(limits);
  WebSocketClient before(echoing.port, "echo.v1");
  std::vector<std::unique_ptr<Socket>> half_open;
  for (int i = 0; i < 100; ++i) {
    half_open.push_back(std::make_unique<Socket>(echoing.port));
    half_open.back()->send("GET /page HTTP/1.1\r\n");
  }
  echoing.check_alive();
  CHECK(echoing.status("/page?token=secret", echoing.host) == 200);
  before.send_text("still there");
  CHECK(before.receive()->bytes == "still there");
  CHECK(half_open.front()->receive_all().empty());  // the oldest was closed, before its time for a request was over
}

TEST_CASE("tokens are random, and compared as a whole") {
  CHECK(random_token().size() == 32);
  CHECK(random_token() != random_token());
  CHECK(same_secret("abc", "abc"));
  CHECK_FALSE(same_secret("abc", "abd"));
  CHECK_FALSE(same_secret("abc", "ab"));
}

TEST_CASE("a WebSocket has the first sub-protocol of the client that the server supports, or none at all") {
  Echoing echoing;
  WebSocketClient client(echoing.port, "other.v1, echo.v2, echo.v1");
  CHECK(client.head().find("Sec-WebSocket-Protocol: echo.v2\r\n") != std::string::npos);
  CHECK(client.head().find("Sec-WebSocket-Accept: s3pPLMBiTxaQ9kYGzzhZRbK+xOo=\r\n") != std::string::npos);
  CHECK_THROWS(WebSocketClient(echoing.port, "other.v1"));
}

TEST_CASE("messages of all sizes and in fragments come through, and those that are too long end the connection") {
  ServerLimits limits;
  limits.message_bytes = 200'000;
  Echoing echoing(limits);
  WebSocketClient client(echoing.port, "echo.v1");
  for (const std::size_t size : {0, 1, 125, 126, 65'535, 65'536, 200'000}) {
    CAPTURE(size);
    client.send_binary(std::string(size, 'x'));
    const std::optional<test::WebMessage> back = client.receive();
    REQUIRE(back);
    CHECK(back->binary);
    CHECK(back->bytes == std::string(size, 'x'));
  }
  client.socket().send(WebSocketClient::frame("one ", 1, false) + WebSocketClient::frame("", 9) +
                       WebSocketClient::frame("two", 0, true));
  CHECK(client.receive()->bytes == "one two");
  client.send_binary(std::string(200'001, 'x'));
  CHECK_FALSE(client.receive());
  WebSocketClient other(echoing.port, "echo.v1");
  other.send_text("bad");
  CHECK_FALSE(other.receive());
  CHECK(other.close_reason() == "a bad message");
  wait_for_none(echoing.service);
}

TEST_CASE("who takes too long for a request, or for a message, or answers no ping, is closed") {
  ServerLimits limits;
  limits.request = limits.message = std::chrono::seconds(1);
  limits.idle = std::chrono::seconds(2);
  Echoing echoing(limits);
  Socket silent(echoing.port), slow(echoing.port);
  slow.send("GET /page HTTP/1.1\r\n");
  WebSocketClient half(echoing.port, "echo.v1"), answering(echoing.port, "echo.v1"), deaf(echoing.port, "echo.v1");
  std::optional<test::WebMessage> answer;
  std::thread listening([&] { answer = answering.receive(); });  // and answers pings
  half.socket().send(WebSocketClient::frame("begin", 1, false));
  std::atomic<bool> ends = false;
  std::thread dripping([&] {  // a byte now and then does not buy time
    while (!ends && slow.send("X") && half.socket().send(WebSocketClient::frame("x", 0, false))) {
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
  });
  CHECK(silent.receive_all().empty());
  CHECK(slow.receive_all().empty());
  CHECK_NOTHROW(half.socket().receive_all());
  CHECK_NOTHROW(deaf.socket().receive_all());
  ends = true;
  dripping.join();
  answering.send_text("a client that answers pings stays");
  listening.join();
  CHECK((answer && answer->bytes == "a client that answers pings stays"));
  answering.socket().close();
  wait_for_none(echoing.service);
  echoing.check_alive();
}

TEST_CASE("a client that takes no messages is closed after the time for one") {
  ServerLimits limits;
  limits.response = std::chrono::seconds(1);
  limits.idle = std::chrono::seconds(10 * test::kPatience_ms / 1000);
  Echoing echoing(limits);
  WebSocketClient deaf(echoing.port, "echo.v1");
  const std::string message(limits.message_bytes, 'x');
  // Sockets hold a few MiB for a reader that does not read.
  for (int i = 0; i < 64 && deaf.send_binary(message); ++i) {
  }
  wait_for_none(echoing.service);
  echoing.check_alive();
}

TEST_CASE("of a thousand connections only as many are held as the limit says, and none is left over") {
  ServerLimits limits;
  limits.connections = limits.strangers = 20;
  Echoing echoing(limits);
  echoing.check_alive();
  wait_for_none(echoing.service);
  const std::size_t before = open_files();
  {
    std::vector<std::unique_ptr<Socket>> all;
    for (int i = 0; i < 1000; ++i) {
      all.push_back(std::make_unique<Socket>(echoing.port));
      all.back()->send("GET /page HTTP/1.1\r\n");
    }
    CHECK(all.front()->receive_all().empty());                            // closed at once
    CHECK(open_files() <= before + all.size() + limits.connections + 1);  // and the one that is being accepted
  }
  for (int i = 0; i < 6000 && open_files() > before; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  CHECK(open_files() <= before);
  echoing.check_alive();
}

TEST_CASE("random bytes, as requests and as frames, end their connection and nothing else") {
  Echoing echoing;
  std::mt19937 random(7);
  const auto bytes = [&](std::size_t most) {
    std::string text(random() % most, '\0');
    for (char& c : text) c = static_cast<char>(random());
    return text;
  };
  const std::string good = WebSocketClient::handshake(echoing.port, "echo.v1");
  const std::string frame = WebSocketClient::frame("{\"op\":\"look\"}", 1);
  for (int i = 0; i < 1500; ++i) {
    Socket socket(echoing.port);
    std::string request = good;
    if (i % 3 == 0) request[random() % request.size()] = static_cast<char>(random());
    socket.send(request);
    std::string frames = frame + bytes(40);
    if (i % 2 == 0) frames = frame.substr(0, random() % frame.size()) + bytes(40);
    for (int flips = i % 4; flips > 0; --flips)
      frames[random() % frames.size()] ^= static_cast<char>(1 << random() % 8);
    socket.send(frames);
  }
  echoing.check_alive();
  wait_for_none(echoing.service);
}

TEST_CASE("the server ends while clients are connected, and its port is free again") {
  EchoService service;
  std::uint16_t port = 0;
  std::optional<WebSocketClient> client;
  {
    Server server({.token = "secret"}, service);
    port = server.port();
    test::open_link(port, "secret");
    client.emplace(port, "echo.v1");
    Socket silent(port);
    CHECK_THROWS_AS(Server({.port = port}, service), MachineError);
  }
  CHECK_FALSE(client->receive());
  CHECK(client->close_reason() == "the simulation has ended");
  CHECK(service.alive == 0);
  Server again({.port = port}, service);
  CHECK(again.port() == port);
  CHECK_THROWS_AS(Server({.address = "nowhere.example"}, service), InputError);
}

}  // namespace simvis::live

TEST_SUITE_END();
