// Reads the UDP datagrams of capture files (pcap, as tcpdump and Wireshark write it).
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string_view>

namespace simvis {

/// A datagram that was captured. `payload` is valid during the call that gets it.
struct CapturedDatagram {
  std::uint16_t port = 0;  ///< that it was sent to
  std::string_view payload;
};

/// Calls `action` for each datagram of IPv4, in the order of the file, until it returns false. Fragments are joined;
/// packets of other protocols are skipped, and so is a last record that is cut off, as a kill leaves it.
///
/// Forms    pcap of version 2 in either byte order, with microseconds or nanoseconds; links of Ethernet (also with
///          VLAN tags), of Linux's device "any" and without a header of their own.
/// Errors   InputError naming the file: it cannot be read, is of another form, or a record in the middle is wrong.
void read_pcap(const std::filesystem::path& file, const std::function<bool(const CapturedDatagram&)>& action);

}  // namespace simvis
