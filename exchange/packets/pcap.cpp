#include "exchange/packets/pcap.h"

#include <algorithm>

#include "engine/base/assert.h"
#include "engine/base/binary_numbers.h"
#include "exchange/packets/device_packet.h"

namespace simvis {
namespace {

constexpr std::uint32_t kMagic = 0xa1b2c3d4, kSnapBytes = 65535, kEthernet = 1;
constexpr std::size_t kIpBytes = 20, kUdpBytes = 8, kMaxFragmentBytes = 1480;  // a multiple of 8
constexpr std::uint16_t kMoreFragments = 0x2000;
constexpr char kUdp = 17;

// Network order.
void append_network(std::string& bytes, std::uint32_t value, std::size_t count) {
  for (std::size_t i = count; i-- > 0;) bytes += static_cast<char>(value >> (8 * i) & 0xff);
}

std::uint16_t checksum_of(std::string_view header) {
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i + 1 < header.size(); i += 2) {
    sum += static_cast<std::uint32_t>(static_cast<unsigned char>(header[i])) << 8 |
           static_cast<unsigned char>(header[i + 1]);
  }
  while (sum > 0xffff) sum = (sum & 0xffff) + (sum >> 16);
  return static_cast<std::uint16_t>(~sum);
}

std::string ip_header(const PacketRoute& route, std::uint16_t number, std::uint16_t place, std::size_t content) {
  std::string header("\x45\x00", 2);
  append_network(header, static_cast<std::uint32_t>(kIpBytes + content), 2);
  append_network(header, number, 2);
  append_network(header, place, 2);
  header += '\x40';  // hops
  header += kUdp;
  append_network(header, 0, 2);
  append_network(header, route.from, 4);
  append_network(header, route.to, 4);
  const std::uint16_t checksum = checksum_of(header);
  header[10] = static_cast<char>(checksum >> 8);
  header[11] = static_cast<char>(checksum & 0xff);
  return header;
}

}  // namespace

std::string pcap_header() {
  std::string bytes;
  append_binary(bytes, kMagic);
  append_binary(bytes, std::uint16_t{2});
  append_binary(bytes, std::uint16_t{4});
  append_binary(bytes, std::uint64_t{0});
  append_binary(bytes, kSnapBytes);
  append_binary(bytes, kEthernet);
  return bytes;
}

std::string pcap_datagram(const PacketRoute& route, std::int64_t time_ns, std::uint16_t number,
                          std::string_view payload) {
  SIMVIS_ASSERT(time_ns >= 0 && payload.size() + kUdpBytes + kIpBytes <= 0xffff);
  std::string udp;
  append_network(udp, route.port, 2);
  append_network(udp, route.port, 2);
  append_network(udp, static_cast<std::uint32_t>(kUdpBytes + payload.size()), 2);
  append_network(udp, 0, 2);  // no checksum
  udp += payload;
  // To all, or to a made-up station; from a made-up one.
  const std::string stations =
      (route.to == 0xffffffff ? std::string(6, '\xff') : std::string("\x02\x00\x00\x00\x00\x02", 6)) +
      std::string("\x02\x00\x00\x00\x00\x01", 6) + std::string("\x08\x00", 2);
  std::string records;
  for (std::size_t first = 0; first < udp.size(); first += kMaxFragmentBytes) {
    const std::size_t count = std::min(kMaxFragmentBytes, udp.size() - first);
    const std::uint16_t more = first + count < udp.size() ? kMoreFragments : std::uint16_t{0};
    const std::string frame = stations + ip_header(route, number, static_cast<std::uint16_t>(more | first / 8), count) +
                              udp.substr(first, count);
    append_binary(records, static_cast<std::uint32_t>(time_ns / 1'000'000'000));
    append_binary(records, static_cast<std::uint32_t>(time_ns % 1'000'000'000 / 1000));
    append_binary(records, static_cast<std::uint32_t>(frame.size()));
    append_binary(records, static_cast<std::uint32_t>(frame.size()));
    records += frame;
  }
  return records;
}

}  // namespace simvis
