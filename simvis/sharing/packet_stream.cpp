#include "simvis/sharing/packet_stream.h"

#include <netdb.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <string>
#include <system_error>

#include <simvis/error.h>
#include <simvis/location.h>
#include "engine/base/words.h"

namespace simvis {
namespace {

struct HostPort {
  std::string host;
  std::uint16_t port = 0;
};

// "HOST" or "HOST:PORT", with an address of IPv6 in brackets.
HostPort host_port(const std::string& address, std::uint16_t default_port) {
  const std::size_t bracket = address.rfind(']');
  const std::size_t colon = address.find(':', bracket == std::string::npos ? 0 : bracket);
  HostPort parts{address.substr(0, colon), default_port};
  if (parts.host.starts_with('[') && parts.host.ends_with(']'))
    parts.host = parts.host.substr(1, parts.host.size() - 2);
  if (colon == std::string::npos && !parts.host.empty()) return parts;
  const std::string_view behind = colon == std::string::npos ? "" : std::string_view(address).substr(colon + 1);
  parts.port = as_number<std::uint16_t>(behind).value_or(0);
  if (parts.host.empty() || parts.port == 0) {
    throw InputError(in_quotes(address) + " is no address, expected HOST or HOST:PORT with a port from 1 to 65535");
  }
  return parts;
}

/// A name without an address is a wrong name. All else is the machine's: no answer of the resolver, no memory.
[[noreturn]] void throw_no_address(const std::string& host, int error, int system_error) {
  if (error == EAI_NONAME || error == EAI_NODATA || error == EAI_ADDRFAMILY) {
    throw InputError(in_quotes(host) + " names no host: " + ::gai_strerror(error));
  }
  throw MachineError("the address of " + in_quotes(host) + " cannot be looked up: " +
                     (error == EAI_SYSTEM ? std::generic_category().message(system_error) : ::gai_strerror(error)));
}

}  // namespace

PacketStream::PacketStream(const PacketStreamDesc& desc, const BuiltScene& scene) : scanner_(desc.sensor, scene) {
  const HostPort to = host_port(desc.address, scanner_.port());
  addrinfo hints{};
  hints.ai_socktype = SOCK_DGRAM;
  hints.ai_family = AF_INET;  // preferred: these devices, and so their drivers, have addresses of IPv4 alone
  addrinfo* found = nullptr;
  const auto look_up = [&] { return ::getaddrinfo(to.host.c_str(), std::to_string(to.port).c_str(), &hints, &found); };
  int error = look_up();
  if (error != 0) {
    hints.ai_family = AF_UNSPEC;
    error = look_up();
  }
  if (error != 0) throw_no_address(to.host, error, errno);
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> list(found, &::freeaddrinfo);
  std::memcpy(&to_, found->ai_addr, found->ai_addrlen);
  to_bytes_ = found->ai_addrlen;
  socket_ = ::socket(found->ai_family, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (socket_ < 0) throw MachineError("no socket for UDP: " + std::generic_category().message(errno));
  // Devices send to all by default, 255.255.255.255 or that of their network.
  constexpr int kOn = 1;
  if (found->ai_family == AF_INET && ::setsockopt(socket_, SOL_SOCKET, SO_BROADCAST, &kOn, sizeof kOn) != 0) {
    ::close(socket_);
    throw MachineError("no broadcasts by UDP: " + std::generic_category().message(errno));
  }
}

PacketStream::~PacketStream() { ::close(socket_); }

void PacketStream::frame(const Frame& frame) {
  for (const DevicePacket& packet : scanner_.packets(frame)) {
    const auto* const to = reinterpret_cast<const sockaddr*>(&to_);
    ssize_t sent = -1;
    do {
      sent = ::sendto(socket_, packet.bytes.data(), packet.bytes.size(), 0, to, to_bytes_);
    } while (sent < 0 && errno == EINTR);
    if (sent < 0) throw MachineError("cannot send a packet: " + std::generic_category().message(errno));
    ++packets_;
    bytes_ += packet.bytes.size();
  }
}

PacketReport PacketStream::finish() { return {.sensor = scanner_.sensor(), .packets = packets_, .bytes = bytes_}; }

}  // namespace simvis
