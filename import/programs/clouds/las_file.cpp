// Numbers of bytes and fields are those of the LAS Specification 1.4 R15 of the ASPRS.
#include <algorithm>
#include <string>
#include <string_view>

#include <simvis/location.h>
#include "engine/base/input_file.h"
#include "import/programs/clouds/cloud_files.h"
#include "import/programs/clouds/point_columns.h"

namespace simvis {
namespace {

// Of the public header block.
constexpr std::size_t kMajorAt = 24, kMinorAt = 25, kPointsAt = 96, kFormatAt = 104, kLengthAt = 105,
                      kLegacyCountAt = 107, kScaleAt = 131, kOffsetAt = 155, kCountAt = 247, kHeaderBytes = 227,
                      kHeaderBytes4 = 375;
// Of a point: after three coordinates of four bytes.
constexpr std::size_t kIntensityAt = 12;

// By point format: bytes of a record, and where the colour begins; 0: there is none.
struct PointFormat {
  std::size_t bytes = 0, color_at = 0;
};
constexpr PointFormat kFormats[] = {{20, 0}, {28, 0},  {26, 20}, {34, 28}, {57, 0}, {63, 28},
                                    {30, 0}, {36, 30}, {38, 30}, {59, 0},  {67, 30}};

class LasFile {
 public:
  explicit LasFile(const std::filesystem::path& file) : file_(file), bytes_(read_whole_file(file)) {}

  ImportedScene read() const {
    if (bytes_.size() < kHeaderBytes || std::string_view(reinterpret_cast<const char*>(bytes_.data()), 4) != "LASF") {
      fail("is no LAS file: it does not begin with \"LASF\" and a header of 227 bytes");
    }
    const bool is_4 = bytes_[kMinorAt] >= 4;
    if (bytes_[kMajorAt] != 1 || bytes_[kMinorAt] > 5) {
      fail("has the version " + std::to_string(bytes_[kMajorAt]) + "." + std::to_string(bytes_[kMinorAt]) +
           ", expected LAS 1.0 to 1.5");
    }
    if (is_4 && bytes_.size() < kHeaderBytes4)
      fail("ends too early: the header of LAS 1.4 and 1.5 has 375 bytes or more");
    constexpr unsigned kCompressed = 0xc0;
    const unsigned format = bytes_[kFormatAt];
    if (format & kCompressed) fail("is compressed (LAZ), expected LAS: laszip or las2las decompress it");
    if (format >= std::size(kFormats)) fail("has points of format " + std::to_string(format) + ", expected 0 to 10");
    const auto length = static_cast<std::size_t>(natural(kLengthAt, 2)), first = std::size_t(natural(kPointsAt, 4));
    if (length < kFormats[format].bytes) {
      fail("has points of " + std::to_string(length) + " bytes, expected at least " +
           std::to_string(kFormats[format].bytes) + " for format " + std::to_string(format));
    }
    const double of_header = natural(kLegacyCountAt, 4);
    const double count = is_4 && of_header == 0 ? natural(kCountAt, 8) : of_header;
    const std::size_t there = first > bytes_.size() ? 0 : (bytes_.size() - first) / length;
    if (first > bytes_.size() || count > static_cast<double>(there)) {
      fail("ends too early: its header claims " + std::to_string(static_cast<std::uint64_t>(count)) + " points");
    }
    return cloud_scene(columns(first, length, static_cast<std::size_t>(count), kFormats[format].color_at));
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { fail_at({.file = file_.string()}, message); }

  double number(std::size_t at, NumberType type) const { return PointColumn{&bytes_[at], 0, type}.at(0); }
  double natural(std::size_t at, unsigned bytes) const { return number(at, {NumberType::Kind::natural, bytes}); }

  glm::dvec3 vector(std::size_t at) const {
    constexpr NumberType kDouble{NumberType::Kind::real, 8};
    return {number(at, kDouble), number(at + 8, kDouble), number(at + 16, kDouble)};
  }

  PointColumns columns(std::size_t first, std::size_t length, std::size_t count, std::size_t color_at) const {
    const auto column = [&](std::size_t at, NumberType type) {
      return PointColumn{bytes_.data() + first + at, length, type};
    };
    constexpr NumberType kCoordinate{NumberType::Kind::whole, 4}, kShort{NumberType::Kind::natural, 2};
    PointColumns columns{.file = file_,
                         .count = count,
                         .place = {column(0, kCoordinate), column(4, kCoordinate), column(8, kCoordinate)},
                         .has_more_digits = true,
                         .scale = vector(kScaleAt),
                         .offset = vector(kOffsetAt)};
    if (color_at != 0) {
      for (std::size_t i = 0; i < 3; ++i) columns.color.push_back(column(color_at + 2 * i, kShort));
      fit_color_range(columns);
    }
    columns.intensity = column(kIntensityAt, kShort);
    return columns;
  }

  std::filesystem::path file_;
  Bytes bytes_;
};

}  // namespace

ImportedScene read_las(const std::filesystem::path& file) { return LasFile(file).read(); }

}  // namespace simvis
