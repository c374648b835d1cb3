// The bytes of a capture file of network packets (pcap, version 2.4, microseconds, Ethernet).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace simvis {

/// Where packets come from and go to. Addresses are IPv4, as 0xc0a801c9 for 192.168.1.201.
struct PacketRoute {
  std::uint32_t from = 0xc0a801c9, to = 0xffffffff;
  std::uint16_t port = 0;  ///< of both sides
};

/// The 24 bytes at the beginning of a file.
std::string pcap_header();

/// The records of one datagram at this time, which is not negative: an Ethernet frame, or several with its fragments if
/// it does not fit into 1500 bytes. `number` identifies the datagram among those that are under way.
std::string pcap_datagram(const PacketRoute& route, std::int64_t time_ns, std::uint16_t number,
                          std::string_view payload);

}  // namespace simvis
