// A host in shared memory with a few elements and one sensor, for tests of clients.
#pragma once

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <simvis_client/connection.h>
#include "exchange/clients/host.h"

namespace simvis {

/// A name that no other test of this machine has.
inline std::string unique_name(const std::string& test) { return "test-" + test + "-" + std::to_string(::getpid()); }

/// The address at which a host of this name listens.
struct HostAddress {
  explicit HostAddress(const std::string& name) {
    const std::string text = SIMVIS_SHM_PREFIX + name;
    address.sun_family = AF_UNIX;
    text.copy(address.sun_path + 1, sizeof address.sun_path - 1);
    size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + text.size());
  }
  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&address); }

  sockaddr_un address{};
  socklen_t size;
};

/// Whether a process listens under the name.
inline bool is_served(const std::string& name) {
  const HostAddress address(name);
  const int asking = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const bool connected = ::connect(asking, address.get(), address.size) == 0;
  ::close(asking);
  return connected;
}

/// A descriptor of the host's memory, which a client receives. Throws std::runtime_error if it receives none.
inline int open_object(const std::string& name) {
  const HostAddress address(name);
  const int host = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  char content = 0;
  iovec part{&content, 1};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> control{};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  const bool received =
      ::connect(host, address.get(), address.size) == 0 && ::recvmsg(host, &message, MSG_CMSG_CLOEXEC) == 1;
  const cmsghdr* const head = received ? CMSG_FIRSTHDR(&message) : nullptr;
  ::close(host);
  if (head == nullptr) throw std::runtime_error("no descriptor of " + name);
  int object = -1;
  std::memcpy(&object, CMSG_DATA(head), sizeof object);
  return object;
}

inline constexpr std::size_t kPoseValues = 6;
inline constexpr std::array<double, 16> kIdentity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

/// Adds an element with x, y, z in [-10, 10] m and three angles without limits, all 0.
inline std::size_t add_pose(SharedHost& host, const std::string& name) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::vector<SharedParameter> rows;
  for (const char* axis : {"x", "y", "z"}) rows.push_back({axis, "m", -10, 10, false, false, 0});
  for (const char* angle : {"roll", "pitch", "yaw"}) {
    rows.push_back({angle, "deg", -kInfinity, kInfinity, false, false, 0});
  }
  return host.add_element(name, "pose", "ROOT", rows);
}

/// A scan whose ranges are all `value`.
inline void publish_scan(SharedHost& host, std::size_t sensor, std::uint64_t frame, float value) {
  const MeasuredArray ranges{{.name = "range_m", .shape = {1, 361}},
                             SharedArray<float>(std::vector<float>(361, value))};
  host.publish(sensor, frame, static_cast<std::int64_t>(frame) * 1000, kIdentity, {&ranges, 1});
}

}  // namespace simvis
