#include "exchange/clients/client_listener.h"

#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <mutex>
#include <optional>
#include <set>
#include <system_error>

#include <simvis/error.h>
#include <simvis_client/shared_memory.h>

namespace simvis {
namespace {

// A process without free descriptors tries again after this time, instead of all the time.
constexpr useconds_t kRetryPause_us = 20'000;

[[noreturn]] void fail_socket(int error) {
  throw MachineError("no socket for clients of the shared memory: " + std::generic_category().message(error));
}

struct SocketName {
  explicit SocketName(const std::string& name) {
    address.sun_family = AF_UNIX;
    const std::string text = SIMVIS_SHM_PREFIX + name;
    // The zero in front makes the name abstract: it has no file, and ends with the socket.
    text.copy(address.sun_path + 1, sizeof address.sun_path - 1);
    size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + text.size());
  }
  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&address); }

  sockaddr_un address{};
  socklen_t size;
};

// The listening sockets of this process. A forked child closes its copies.
class OpenListeners {
 public:
  static OpenListeners& of_process() {
    static OpenListeners* const all = new OpenListeners;  // outlives every host
    return *all;
  }
  void add(int socket) {
    const std::lock_guard lock(mutex_);
    sockets_.insert(socket);
  }
  void close(int socket) {
    const std::lock_guard lock(mutex_);
    sockets_.erase(socket);
    ::close(socket);
  }

 private:
  OpenListeners() {
    const int error = ::pthread_atfork([] { of_process().mutex_.lock(); }, [] { of_process().mutex_.unlock(); },
                                       [] { of_process().leave_to_parent(); });
    if (error != 0) fail_socket(error);
  }
  void leave_to_parent() {
    for (const int socket : sockets_) ::close(socket);
    sockets_.clear();
    mutex_.unlock();
  }

  std::mutex mutex_;
  std::set<int> sockets_;
};

int new_socket() {
  const int made = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (made < 0) fail_socket(errno);
  return made;
}

std::optional<ucred> peer_of(int connection) {
  ucred peer{};
  socklen_t size = sizeof peer;
  if (::getsockopt(connection, SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) return std::nullopt;
  return peer;
}

// The process that listens under the name; empty if it does so no more.
std::optional<ucred> owner_of(const SocketName& name) {
  const int asking = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (asking < 0) return std::nullopt;
  std::optional<ucred> owner;
  if (::connect(asking, name.get(), name.size) == 0) owner = peer_of(asking);
  ::close(asking);
  return owner;
}

[[noreturn]] void refuse_name(const std::string& name, const std::optional<ucred>& owner) {
  if (owner && owner->uid != ::geteuid()) {
    throw InputError("process " + std::to_string(owner->pid) + " of another user (" + std::to_string(owner->uid) +
                     ") has the name \"" + name + "\", expected another name");
  }
  throw InputError("a living simulation is served as \"" + name + "\", expected another name");
}

int listen_as(const std::string& name) {
  const SocketName address(name);
  const int made = new_socket();
  if (::bind(made, address.get(), address.size) == 0 && ::listen(made, SOMAXCONN) == 0) return made;
  const int error = errno;
  ::close(made);
  if (error == EADDRINUSE) refuse_name(name, owner_of(address));
  fail_socket(error);
}

// An open file description of its own: clients hold locks by theirs.
int open_again(int object) { return ::open(("/proc/self/fd/" + std::to_string(object)).c_str(), O_RDWR | O_CLOEXEC); }

// A client that does not take the message loses it: nothing waits here.
void send_object(int connection, int object) {
  const int opened = open_again(object);
  if (opened < 0) return;
  char content = 0;
  iovec part{&content, sizeof content};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof opened)> control{};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  cmsghdr* const head = CMSG_FIRSTHDR(&message);
  head->cmsg_level = SOL_SOCKET;
  head->cmsg_type = SCM_RIGHTS;
  head->cmsg_len = CMSG_LEN(sizeof opened);
  std::memcpy(CMSG_DATA(head), &opened, sizeof opened);
  ::sendmsg(connection, &message, MSG_NOSIGNAL | MSG_DONTWAIT);
  ::close(opened);
}

}  // namespace

ClientListener::ClientListener(const std::string& name, int object, SharedAccess access)
    : socket_(listen_as(name)), object_(object), access_(access) {
  const int opened = open_again(object);
  if (opened < 0) {
    const int error = errno;
    ::close(socket_);
    throw MachineError("/proc/self/fd, by which clients get the shared memory: " +
                       std::generic_category().message(error));
  }
  ::close(opened);
  OpenListeners::of_process().add(socket_);
  // Signals of the process are for the threads of its user.
  sigset_t all, before;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  std::error_code error;
  try {
    thread_ = std::thread([this] { answer_clients(); });
  } catch (const std::system_error& failed) {
    error = failed.code();
  }
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  if (!error) return;
  OpenListeners::of_process().close(socket_);
  fail_socket(error.value());
}

ClientListener::~ClientListener() {
  ::shutdown(socket_, SHUT_RDWR);  // ends accept()
  thread_.join();
  OpenListeners::of_process().close(socket_);
}

void ClientListener::answer_clients() const {
  for (;;) {
    const int connection = ::accept4(socket_, nullptr, nullptr, SOCK_CLOEXEC);
    if (connection < 0 && errno == EINVAL) return;  // shut down
    if (connection < 0) {
      ::usleep(kRetryPause_us);
      continue;
    }
    if (admits(connection)) send_object(connection, object_);
    ::close(connection);
  }
}

bool ClientListener::admits(int connection) const {
  const std::optional<ucred> client = peer_of(connection);
  if (!client) return false;
  return client->uid == ::geteuid() || (access_ == SharedAccess::group && client->gid == ::getegid());
}

}  // namespace simvis
