#include "exchange/packets/pcap_reader.h"

#include <map>
#include <optional>
#include <string>
#include <tuple>

#include <simvis/error.h>
#include "engine/base/input_file.h"

namespace simvis {
namespace {

constexpr std::size_t kFileHeaderBytes = 24, kRecordHeaderBytes = 16, kBufferBytes = std::size_t{1} << 20;
constexpr std::uint32_t kMaxRecordBytes = 1u << 18;  // the largest snapshot of libpcap
constexpr std::uint32_t kLinkEthernet = 1, kLinkRaw = 101, kLinkLinuxAny = 113;
constexpr std::uint64_t kEtherIpv4 = 0x0800, kEtherVlan = 0x8100, kEtherProviderVlan = 0x88a8;
constexpr std::uint64_t kProtocolUdp = 17;
constexpr std::size_t kMaxPending = 64;  // datagrams of which fragments are missing

std::uint64_t network_number(std::string_view bytes, std::size_t at, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < count; ++i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

class PcapReader {
 public:
  explicit PcapReader(const std::filesystem::path& path) : path_(path), file_(path) {
    const std::string_view head = take(kFileHeaderBytes);
    if (head.size() < kFileHeaderBytes) fail("is no capture file, expected pcap");
    const std::uint64_t magic = network_number(head, 0, 4);
    if (magic == 0x0a0d0d0a) fail("is a capture file of the form pcapng, expected pcap: editcap -F pcap converts it");
    swapped_ = magic == 0xd4c3b2a1 || magic == 0x4d3cb2a1;
    if (!swapped_ && magic != 0xa1b2c3d4 && magic != 0xa1b23c4d) fail("is no capture file, expected pcap");
    if (number(head, 4, 2) != 2) fail("is of another version of pcap, expected version 2");
    link_ = number(head, 20, 4) & 0xffff;
    if (link_ != kLinkEthernet && link_ != kLinkRaw && link_ != kLinkLinuxAny) {
      fail("was captured on a link of type " + std::to_string(link_) +
           ", expected Ethernet (1), IP (101) or Linux (113)");
    }
  }

  void read(const std::function<bool(const CapturedDatagram&)>& action) {
    for (;;) {
      const std::string_view head = take(kRecordHeaderBytes);
      if (head.size() < kRecordHeaderBytes) return;
      const std::uint64_t bytes = number(head, 8, 4);
      if (bytes > kMaxRecordBytes) {
        fail("has a record of " + std::to_string(bytes) + " bytes at byte " + std::to_string(at_ - kRecordHeaderBytes) +
             ", expected at most " + std::to_string(kMaxRecordBytes));
      }
      const std::string_view frame = take(bytes);
      if (frame.size() < bytes) return;
      const std::optional<CapturedDatagram> datagram = datagram_of(frame);
      if (datagram && !action(*datagram)) return;
    }
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw InputError(path_.string() + ": error: " + what); }

  std::uint64_t number(std::string_view bytes, std::size_t at, std::size_t count) const {
    if (!swapped_) return network_number(bytes, at, count);
    std::uint64_t value = 0;
    for (std::size_t i = count; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
    return value;
  }

  // The next bytes; fewer at the end of the file. They are valid until the next call.
  std::string_view take(std::size_t count) {
    if (buffer_.size() - used_ < count) {
      buffer_.erase(0, used_);
      used_ = 0;
      const std::size_t had = buffer_.size();
      buffer_.resize(std::max(count, kBufferBytes));
      const std::size_t read =
          file_.read_into({reinterpret_cast<std::uint8_t*>(buffer_.data()) + had, buffer_.size() - had}, at_ + had);
      buffer_.resize(had + read);
    }
    const std::string_view front = std::string_view(buffer_).substr(used_, count);
    used_ += front.size();
    at_ += front.size();
    return front;
  }

  // The IPv4 packet of a frame; empty if it has none.
  std::string_view ip_of(std::string_view frame) const {
    std::size_t type_at = link_ == kLinkEthernet ? 12 : 14;
    if (link_ == kLinkRaw) return frame;
    while (frame.size() >= type_at + 2) {
      const std::uint64_t type = network_number(frame, type_at, 2);
      if (type == kEtherIpv4) return frame.substr(type_at + 2);
      if (type != kEtherVlan && type != kEtherProviderVlan) break;
      type_at += 4;
    }
    return {};
  }

  std::optional<CapturedDatagram> datagram_of(std::string_view frame) {
    const std::string_view ip = ip_of(frame);
    if (ip.size() < 20 || network_number(ip, 0, 1) >> 4 != 4 || network_number(ip, 9, 1) != kProtocolUdp) return {};
    const std::size_t head = (network_number(ip, 0, 1) & 15) * 4, length = network_number(ip, 2, 2);
    if (head < 20 || length < head || length > ip.size()) return {};  // cut off by the snapshot
    const std::string_view content = ip.substr(head, length - head);
    const std::uint64_t place = network_number(ip, 6, 2);
    if ((place & 0x3fff) == 0) return udp_of(content);
    return joined(ip, content, 8 * (place & 0x1fff), (place & 0x2000) != 0);
  }

  // Fragments come in order, as senders send them; a gap drops the datagram.
  std::optional<CapturedDatagram> joined(std::string_view ip, std::string_view content, std::size_t offset, bool more) {
    const auto key = std::tuple(network_number(ip, 12, 8), network_number(ip, 4, 2));
    std::string& whole = pending_[key];
    if (offset == 0) whole.clear();
    if (whole.size() != offset) {
      pending_.erase(key);
      return {};
    }
    whole += content;
    if (more) {
      if (pending_.size() > kMaxPending) pending_.erase(pending_.begin());
      return {};
    }
    joined_ = std::move(whole);
    pending_.erase(key);
    return udp_of(joined_);
  }

  static std::optional<CapturedDatagram> udp_of(std::string_view udp) {
    if (udp.size() < 8) return {};
    const std::size_t length = network_number(udp, 4, 2);
    if (length < 8 || length > udp.size()) return {};
    return CapturedDatagram{static_cast<std::uint16_t>(network_number(udp, 2, 2)), udp.substr(8, length - 8)};
  }

  std::filesystem::path path_;
  InputFile file_;
  std::string buffer_;
  std::size_t used_ = 0, at_ = 0;  // in the buffer, in the file
  bool swapped_ = false;
  std::uint64_t link_ = 0;
  std::map<std::tuple<std::uint64_t, std::uint64_t>, std::string> pending_;  // by addresses and number
  std::string joined_;
};

}  // namespace

void read_pcap(const std::filesystem::path& file, const std::function<bool(const CapturedDatagram&)>& action) {
  PcapReader(file).read(action);
}

}  // namespace simvis
