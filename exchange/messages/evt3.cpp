#include "exchange/messages/evt3.h"

#include <utility>

#include "engine/base/assert.h"

namespace simvis {
namespace {

enum Evt3Kind : std::uint16_t { kRow = 0, kColumn = 2, kTimeLow = 6, kTimeHigh = 8 };
constexpr std::int64_t kTimeBits = 12, kTimeMask = 0xfff;

class Evt3Words {
 public:
  explicit Evt3Words(std::int64_t begin_us) : high_(begin_us >> kTimeBits) { add(kTimeHigh, high_); }

  /// Every upper part 0 on the way tells the reader that the time begins again.
  void advance(std::int64_t time_us) {
    const std::int64_t high = time_us >> kTimeBits;
    SIMVIS_ASSERT(high >= high_);
    for (std::int64_t wrap = (high_ | kTimeMask) + 1; wrap <= high; wrap += kTimeMask + 1) {
      if (high_ < wrap - 1) add(kTimeHigh, kTimeMask);
      add(kTimeHigh, 0);
      high_ = wrap;
    }
    if (high != high_) add(kTimeHigh, high);
    high_ = high;
  }

  void add(Evt3Kind kind, std::int64_t value) {
    const auto word = static_cast<std::uint16_t>(kind << kTimeBits | (value & kTimeMask));
    bytes_.push_back(static_cast<std::uint8_t>(word & 0xff));
    bytes_.push_back(static_cast<std::uint8_t>(word >> 8));
  }

  std::vector<std::uint8_t> take() { return std::move(bytes_); }

 private:
  std::int64_t high_;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace

std::vector<std::uint8_t> encode_evt3(std::span<const CameraEvent> events) {
  return encode_evt3(events, 0, events.empty() ? 0 : events.back().time_us);
}

std::vector<std::uint8_t> encode_evt3(std::span<const CameraEvent> events, std::int64_t begin_us, std::int64_t end_us) {
  Evt3Words words(begin_us);
  std::int64_t time_us = -1, row = -1;
  for (const CameraEvent& event : events) {
    SIMVIS_ASSERT(event.x < kMaxEvt3Size_px && event.y < kMaxEvt3Size_px);
    if (event.time_us != time_us) {
      time_us = event.time_us;
      words.advance(time_us);
      words.add(kTimeLow, time_us);
    }
    if (event.y != row) {
      row = event.y;
      words.add(kRow, row);
    }
    words.add(kColumn, event.x | (event.on ? 1 << 11 : 0));
  }
  words.advance(end_us);
  return words.take();
}

std::string evt3_header(std::uint32_t width_px, std::uint32_t height_px) {
  const std::string width = std::to_string(width_px), height = std::to_string(height_px);
  return "% evt 3.0\n% format EVT3;height=" + height + ";width=" + width + "\n% geometry " + width + "x" + height +
         "\n% end\n";
}

}  // namespace simvis
