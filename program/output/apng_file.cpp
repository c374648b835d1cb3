#include "program/output/apng_file.h"

#include <zlib.h>

#include <algorithm>

#include "engine/base/assert.h"
#include "engine/base/output_target.h"
#include "program/output/formats.h"

namespace simvis {
namespace {

// A PNG is its signature, the chunk IHDR, one chunk IDAT and the chunk IEND. A chunk is its size, its type, its data
// and a checksum.
constexpr std::size_t kStartBytes = 8 + 25, kEndBytes = 12, kBeforeData = 8, kAfterData = 4;
constexpr std::size_t kSizeAt = 16, kSizeBytes = 8;  // width and height in the IHDR

void append_big_endian(std::string& bytes, std::uint32_t value) {
  for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>(value >> shift & 0xff);
}

void append_u16(std::string& bytes, std::uint32_t value) {
  bytes += {static_cast<char>(value >> 8 & 0xff), static_cast<char>(value & 0xff)};
}

std::string chunk(const char (&type)[5], std::string_view data) {
  std::string bytes;
  append_big_endian(bytes, static_cast<std::uint32_t>(data.size()));
  bytes.append(type, 4).append(data);
  const auto* const summed = reinterpret_cast<const Bytef*>(bytes.data()) + 4;
  append_big_endian(bytes, static_cast<std::uint32_t>(crc32_z(0, summed, bytes.size() - 4)));
  return bytes;
}

std::string animation_control(std::uint32_t pictures) {
  std::string data;
  append_big_endian(data, pictures);
  append_big_endian(data, 0);  // without end
  return chunk("acTL", data);
}

std::string picture_control(std::uint32_t sequence, std::string_view size, std::int64_t shown_ms) {
  std::string data;
  append_big_endian(data, sequence);
  data += size;
  append_big_endian(data, 0);  // the upper left corner
  append_big_endian(data, 0);
  append_u16(data, static_cast<std::uint32_t>(shown_ms));
  append_u16(data, 1000);
  data += {0, 0};  // nothing is cleared, and the picture replaces the one before it
  return chunk("fcTL", data);
}

}  // namespace

ApngFile::ApngFile(const std::filesystem::path& path) : file_(regular_target(path)) {}

void ApngFile::add(std::int64_t time_ns, std::string_view png) {
  SIMVIS_ASSERT(png.size() > kStartBytes + kBeforeData + kAfterData + kEndBytes);
  SIMVIS_ASSERT(png.substr(kStartBytes + 4, 4) == "IDAT");
  if (start_.empty()) {
    start_ = png.substr(0, kStartBytes);
    file_.write(start_);
    file_.write(animation_control(0));
  }
  SIMVIS_ASSERT(png.starts_with(start_));
  const std::int64_t time_ms = (time_ns + 500'000) / 1'000'000;
  if (!waiting_.empty()) write_waiting(time_ms - waiting_ms_);
  png.remove_prefix(kStartBytes + kBeforeData);
  png.remove_suffix(kEndBytes + kAfterData);
  waiting_ = png;
  waiting_ms_ = time_ms;
}

// Controls and data are numbered together; the data of the first picture has no number.
void ApngFile::write_waiting(std::int64_t shown_ms) {
  SIMVIS_ASSERT(shown_ms >= 0);
  shown_ms_ = std::min(shown_ms, kMaxShown_ms);
  const std::uint32_t number = written_++;
  file_.write(picture_control(number == 0 ? 0 : 2 * number - 1, std::string_view(start_).substr(kSizeAt, kSizeBytes),
                              shown_ms_));
  if (number == 0) {
    file_.write(chunk("IDAT", waiting_));
  } else {
    std::string data;
    append_big_endian(data, 2 * number);
    file_.write(chunk("fdAT", data.append(waiting_)));
  }
}

void ApngFile::finish() {
  if (waiting_.empty()) return;
  write_waiting(shown_ms_);
  waiting_.clear();
  file_.write(chunk("IEND", ""));
  file_.rewrite(start_.size(), animation_control(written_));
  file_.commit();
}

namespace {

const FormatRegistration kApngFormat(
    {.kind = "color",
     .name = "apng",
     .file = "CAMERA.apng",
     .text =
         "the frames of the run as one animated PNG of 8-bit sRGB, which browsers play at the speed of simulated time; "
         "it appears at the end of the run",
     .order = 10});

}  // namespace

}  // namespace simvis
