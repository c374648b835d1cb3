// SPZ of Niantic Labs: splats in bytes, packed with gzip (versions 2 and 3) or zstd (version 4). The layout is that of
// github.com/nianticlabs/spz, README.md and src/cc/load-spz.cc.
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <new>
#include <numbers>
#include <span>
#include <string>

#include <simvis/location.h>
#include "engine/base/input_file.h"
#include "import/programs/clouds/cloud_files.h"
#include "import/programs/clouds/splat_columns.h"

namespace simvis {
namespace {

constexpr std::size_t kGzipHeaderBytes = 16, kZstdHeaderBytes = 32, kDirectoryEntryBytes = 16;
constexpr std::uint32_t kFirstVersion = 2, kLastGzipVersion = 3, kZstdVersion = 4;

struct SpzHeader {
  std::uint32_t version = 0, count = 0;
  std::uint8_t degree = 0, fractional_bits = 0, flags = 0;

  bool four_byte_rotations() const { return version > kFirstVersion; }
  bool has_extensions() const { return (flags & 2) != 0; }
};

// The numbers of all splats, one kind after the other.
enum Stream : std::size_t { places, opacities, colors, sizes, rotations, harmonics, kStreams };
using Streams = std::array<Bytes, kStreams>;

std::uint64_t whole(std::span<const std::uint8_t> bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = bytes.size(); i > 0; --i) value = value << 8 | bytes[i - 1];
  return value;
}

class SpzReader {
 public:
  explicit SpzReader(const std::filesystem::path& file) : file_(file), bytes_(read_whole_file(file)) {}

  ImportedScene read() {
    if (bytes_.size() >= 2 && bytes_[0] == 0x1f && bytes_[1] == 0x8b) {
      read_gzip();
    } else {
      read_zstd();
    }
    ImportedScene scene = splat_scene(file_, make_cloud(), 0);
    if (header_.has_extensions()) {
      scene.warnings.push_back(file_.string() + ": extensions are left out, a frame of the file's own among them");
    }
    return scene;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { fail_at({.file = file_.string()}, what); }

  void read_header(std::span<const std::uint8_t> bytes, std::uint32_t first_version, std::uint32_t last_version) {
    if (whole(bytes.first(4)) != 0x5053474e) fail("is no SPZ file");
    header_ = {.version = static_cast<std::uint32_t>(whole(bytes.subspan(4, 4))),
               .count = static_cast<std::uint32_t>(whole(bytes.subspan(8, 4))),
               .degree = bytes[12],
               .fractional_bits = bytes[13],
               .flags = bytes[14]};
    if (header_.version < first_version || header_.version > last_version) {
      fail("has the version " + std::to_string(header_.version) + ", expected 2 to 4");
    }
    check_splat_count(file_, header_.count);
    if (header_.degree > kMaxHarmonicsDegree) {
      fail("has spherical harmonics of degree " + std::to_string(header_.degree) + ", expected at most 3");
    }
    constexpr unsigned kMaxFraction = 24;
    if (header_.fractional_bits > kMaxFraction) fail("has places of more fractional bits than 24");
  }

  std::size_t size_of(std::size_t stream) const {
    const std::size_t others = harmonics_count(header_.degree) - 1;
    const std::size_t of_one[kStreams] = {9, 1, 3, 3, header_.four_byte_rotations() ? 4u : 3u, 3 * others};
    return of_one[stream] * header_.count;
  }

  // Unpacks no more than the header says.
  void read_gzip() {
    const std::unique_ptr<z_stream, int (*)(z_stream*)> packed(new z_stream{}, [](z_stream* stream) {
      const int end = inflateEnd(stream);
      delete stream;
      return end;
    });
    constexpr int kGzip = 16 + MAX_WBITS;
    if (inflateInit2(packed.get(), kGzip) != Z_OK) throw std::bad_alloc();
    if (bytes_.size() > std::numeric_limits<uInt>::max()) fail("has more than 4 GiB");
    packed->next_in = bytes_.data();
    packed->avail_in = static_cast<uInt>(bytes_.size());
    const auto unpack = [&](std::size_t size) {
      Bytes unpacked(size);
      packed->next_out = unpacked.data();
      packed->avail_out = static_cast<uInt>(size);
      while (packed->avail_out > 0) {
        const int result = inflate(packed.get(), Z_NO_FLUSH);
        if (result == Z_MEM_ERROR) throw std::bad_alloc();
        if (packed->avail_out > 0 && result != Z_OK) fail("is broken, or ends too early");
      }
      return unpacked;
    };
    // zlib compares checksum and size where the packed bytes end, behind the extensions.
    const auto check_end = [&] {
      std::array<std::uint8_t, 1 << 14> left_out{};
      int result = Z_OK;
      while (result == Z_OK) {
        packed->next_out = left_out.data();
        packed->avail_out = static_cast<uInt>(left_out.size());
        result = inflate(packed.get(), Z_NO_FLUSH);
        if (result == Z_MEM_ERROR) throw std::bad_alloc();
      }
      if (result != Z_STREAM_END) fail("is broken: it ends too early, or its checksum differs");
    };
    read_header(unpack(kGzipHeaderBytes), kFirstVersion, kLastGzipVersion);
    for (std::size_t stream = 0; stream < kStreams; ++stream) streams_[stream] = unpack(size_of(stream));
    check_end();
  }

  void read_zstd() {
    const std::span<const std::uint8_t> bytes(bytes_);
    if (bytes.size() < kZstdHeaderBytes) fail("is no SPZ file");
    read_header(bytes, kZstdVersion, kZstdVersion);
    const std::size_t stream_count = bytes[15], directory = whole(bytes.subspan(16, 4));
    if (directory < kZstdHeaderBytes || directory > bytes.size() ||
        stream_count > (bytes.size() - directory) / kDirectoryEntryBytes) {
      fail("ends within its directory");
    }
    constexpr std::size_t kWithoutHarmonics = kStreams - 1;
    if (stream_count < (header_.degree > 0 ? kStreams : kWithoutHarmonics)) {
      fail("has fewer kinds of numbers than its splats need");
    }
    std::size_t at = directory + stream_count * kDirectoryEntryBytes, entry = 0;
    for (std::size_t stream = 0; stream < kStreams; ++stream) {
      const std::size_t size = size_of(stream);
      if (size == 0) continue;
      const auto of_stream = bytes.subspan(directory + entry++ * kDirectoryEntryBytes, kDirectoryEntryBytes);
      const std::uint64_t packed = whole(of_stream.first(8));
      if (whole(of_stream.subspan(8)) != size || packed > bytes.size() - at) fail("has a directory that does not fit");
      streams_[stream].resize(size);
      if (ZSTD_decompress(streams_[stream].data(), size, bytes.data() + at, packed) != size) fail("is broken");
      at += packed;
    }
  }

  glm::dvec4 rotation(std::size_t i) const {
    constexpr double kSteps = 511;
    glm::dvec4 q(0);
    if (!header_.four_byte_rotations()) {
      for (int c = 0; c < 3; ++c) q[c] = streams_[rotations][3 * i + static_cast<std::size_t>(c)] / 127.5 - 1;
      q.w = std::sqrt(std::max(0.0, 1 - glm::dot(q, q)));
      return q;
    }
    auto packed = static_cast<std::uint32_t>(whole(std::span(streams_[rotations]).subspan(4 * i, 4)));
    const auto largest = static_cast<int>(packed >> 30);
    for (int c = 3; c >= 0; --c) {
      if (c == largest) continue;
      q[c] = (packed & 511) / kSteps / std::numbers::sqrt2 * ((packed >> 9 & 1) != 0 ? -1 : 1);
      packed >>= 10;
    }
    q[largest] = std::sqrt(std::max(0.0, 1 - glm::dot(q, q)));
    return q;
  }

  Splat splat(std::size_t i) const {
    Splat splat;
    for (int axis = 0; axis < 3; ++axis) {
      const std::size_t number = 3 * i + static_cast<std::size_t>(axis);
      auto fixed = static_cast<std::int32_t>(whole(std::span(streams_[places]).subspan(3 * number, 3)));
      if (fixed >= 1 << 23) fixed -= 1 << 24;
      splat.center[axis] = static_cast<float>(std::ldexp(fixed, -static_cast<int>(header_.fractional_bits)));
      splat.sigma[axis] = static_cast<float>(std::exp(streams_[sizes][number] / 16.0 - 10));
    }
    splat.rotation = glm::vec4(glm::normalize(rotation(i)));
    splat.opacity = static_cast<float>(streams_[opacities][i] / 255.0);
    return splat;
  }

  std::shared_ptr<const SplatCloud> make_cloud() {
    const auto cloud = std::make_shared<SplatCloud>();
    cloud->degree = header_.degree;
    const std::size_t others = harmonics_count(header_.degree) - 1;
    const Bytes &color = streams_[colors], &rest = streams_[harmonics];
    constexpr double kColorScale = 0.15;
    for (std::size_t i = 0; i < header_.count; ++i) {
      cloud->splats.push_back(splat(i));
      const auto degree0 = [&](std::size_t c) { return (color[3 * i + c] / 255.0 - 0.5) / kColorScale; };
      cloud->harmonics.emplace_back(degree0(0), degree0(1), degree0(2));
      for (std::size_t k = i * others; k < (i + 1) * others; ++k) {
        const auto of_channel = [&](std::size_t c) { return (rest[3 * k + c] - 128.0) / 128; };
        cloud->harmonics.emplace_back(of_channel(0), of_channel(1), of_channel(2));
      }
    }
    return cloud;
  }

  std::filesystem::path file_;
  Bytes bytes_;
  SpzHeader header_;
  Streams streams_;
};

}  // namespace

ImportedScene read_spz(const std::filesystem::path& file) { return SpzReader(file).read(); }

}  // namespace simvis
