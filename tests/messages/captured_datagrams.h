// Datagrams of a capture file, read as the format says, and the scanners whose packets tests look at.
#pragma once

#include <doctest/doctest.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace simvis::test {

/// A number of `count` bytes with the lowest first.
inline std::uint64_t little(std::string_view bytes, std::size_t at, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < count; ++i)
    value |= std::uint64_t{static_cast<unsigned char>(bytes.at(at + i))} << (8 * i);
  return value;
}

/// A number of `count` bytes with the highest first, as networks have it.
inline std::uint64_t network(std::string_view bytes, std::size_t at, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < count; ++i) value = value << 8 | static_cast<unsigned char>(bytes.at(at + i));
  return value;
}

struct Datagram {
  std::uint64_t time_us = 0;
  std::uint16_t port = 0;
  std::string payload;
  std::size_t fragments = 0;
};

/// Reads a capture file as its format says; whatever does not fit fails.
inline std::vector<Datagram> read_capture(const std::string& bytes) {
  REQUIRE(bytes.size() >= 24);
  REQUIRE(little(bytes, 0, 4) == 0xa1b2c3d4);
  REQUIRE(little(bytes, 4, 2) == 2);
  REQUIRE(little(bytes, 6, 2) == 4);
  REQUIRE(little(bytes, 20, 4) == 1);
  std::vector<Datagram> datagrams;
  std::string udp;
  std::size_t fragments = 0;
  for (std::size_t at = 24; at < bytes.size();) {
    const std::size_t size = little(bytes, at + 8, 4);
    REQUIRE(size == little(bytes, at + 12, 4));
    REQUIRE(size <= 1514);
    const std::string_view frame = std::string_view(bytes).substr(at + 16, size), ip = frame.substr(14);
    REQUIRE(network(frame, 12, 2) == 0x0800);
    REQUIRE(network(ip, 0, 1) == 0x45);
    REQUIRE(network(ip, 2, 2) == ip.size());
    REQUIRE(network(ip, 9, 1) == 17);
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < 20; i += 2) sum += network(ip, i, 2);
    REQUIRE((sum & 0xffff) + (sum >> 16) == 0xffff);
    const std::uint64_t place = network(ip, 6, 2);
    REQUIRE(8 * (place & 0x1fff) == udp.size());
    REQUIRE(network(ip, 4, 2) == datagrams.size() % 65536);
    udp += ip.substr(20);
    ++fragments;
    const std::uint64_t time_us = little(bytes, at, 4) * 1'000'000 + little(bytes, at + 4, 4);
    at += 16 + size;
    if ((place & 0x2000) != 0) continue;
    REQUIRE(network(udp, 4, 2) == udp.size());
    datagrams.push_back({time_us, static_cast<std::uint16_t>(network(udp, 2, 2)), udp.substr(8), fragments});
    udp.clear();
    fragments = 0;
  }
  REQUIRE(udp.empty());
  return datagrams;
}

/// A laser scanner with intensities, as a device sends packets of.
inline std::string device_sensor(const std::string& preset, const std::string& more = {}) {
  return R"(<sensor type="laser_scanner" name="LIDAR" insert_at="ROOT" preset=")" + preset + R"(" intensity="on" )" +
         more + "/>";
}

}  // namespace simvis::test
