#include "program/output/exr_file.h"

#include <OpenEXR/Iex.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfVersion.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <simvis/error.h>
#include "engine/base/assert.h"
#include "engine/base/binary_numbers.h"
#include "program/output/formats.h"
#include "scenegraph/pictures/deflate.h"

namespace simvis {

namespace {

/// An OpenEXR output stream into memory.
class MemoryStream : public Imf::OStream {
 public:
  MemoryStream() : Imf::OStream("picture") {}

  void write(const char bytes[], int count) override {
    const std::size_t end = position_ + static_cast<std::size_t>(count);
    if (end > bytes_.size()) bytes_.resize(end);
    std::memcpy(bytes_.data() + position_, bytes, static_cast<std::size_t>(count));
    position_ = end;
  }
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = position; }

  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
  std::size_t position_ = 0;
};

constexpr std::size_t kNumberBytes = sizeof(float);

/// Rows of a chunk in the compression ZIP.
constexpr std::size_t kChunkRows = 16;

/// The longest name of a channel that readers of the first version of EXR take.
constexpr std::size_t kMaxShortName = 31;

/// One channel of a file and the source of its numbers, which have four bytes each.
struct NamedChannel {
  std::string name;
  Imf::PixelType type;
  const std::byte* first;  // of the first pixel
  std::size_t step;        // in bytes, from pixel to pixel
};

struct ExrImage {
  std::size_t width, height;
  std::vector<NamedChannel> channels;

  void add(std::string name, const Image& image, std::size_t channel) {
    SIMVIS_ASSERT(image.pixels.size() == width * height * image.channels);
    channels.push_back({std::move(name), Imf::FLOAT, reinterpret_cast<const std::byte*>(image.pixels.data() + channel),
                        image.channels * sizeof(float)});
  }
};

// The names that readers of EXR expect of the parts of a vector.
std::string channel_name(const MeasuredArray& image, std::uint32_t channel) {
  constexpr std::string_view kAxes = "XYZW";
  if (image.shape.channels == 1) return image.name;
  return image.name + "." +
         (image.shape.channels <= kAxes.size() ? std::string(1, kAxes[channel]) : std::to_string(channel));
}

void add_origin(const ImageOrigin& origin, Imf::Header& header) {
  header.insert("frame", Imf::IntAttribute(static_cast<int>(origin.time.index)));
  header.insert("time_s", Imf::DoubleAttribute(static_cast<double>(origin.time.time_ns) / 1e9));
  Imath::M44d pose;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) pose[row][column] = origin.world_from_sensor[column][row];
  }
  header.insert("world_from_sensor", Imf::M44dAttribute(pose));
  if (!origin.pinhole) return;
  const Pinhole& p = *origin.pinhole;
  header.insert("camera_matrix", Imf::M33dAttribute({p.fx_px, 0, p.cx_px - 0.5, 0, p.fy_px, p.cy_px - 0.5, 0, 0, 1}));
}

/// Everything before the table of chunks.
std::string front_of(const ExrImage& image, const ImageOrigin& origin) {
  Imf::Header header(static_cast<int>(image.width), static_cast<int>(image.height));
  header.compression() = Imf::ZIP_COMPRESSION;
  add_origin(origin, header);
  bool long_names = false;
  for (const NamedChannel& each : image.channels) {
    header.channels().insert(each.name, Imf::Channel(each.type));
    long_names = long_names || each.name.size() > kMaxShortName;
  }
  const std::uint32_t start[] = {static_cast<std::uint32_t>(Imf::MAGIC),
                                 static_cast<std::uint32_t>(Imf::makeNotTiled(Imf::EXR_VERSION)) |
                                     (long_names ? static_cast<std::uint32_t>(Imf::LONG_NAMES_FLAG) : 0u)};
  MemoryStream stream;
  stream.write(reinterpret_cast<const char*>(start), sizeof start);
  header.writeTo(stream);
  return stream.take();
}

/// The numbers of some rows as EXR orders them: by row, then by channel. `channels` are sorted by name.
void gather(const ExrImage& image, std::size_t first_row, std::size_t rows, std::vector<std::uint8_t>& bytes) {
  bytes.resize(rows * image.channels.size() * image.width * kNumberBytes);
  std::uint8_t* out = bytes.data();
  for (std::size_t y = first_row; y < first_row + rows; ++y) {
    for (const NamedChannel& each : image.channels) {
      const std::byte* in = each.first + y * image.width * each.step;
      for (std::size_t x = 0; x < image.width; ++x, in += each.step, out += kNumberBytes) {
        std::memcpy(out, in, kNumberBytes);
      }
    }
  }
}

// The compressor sees the difference of each byte to the one two before it.
constexpr std::size_t kApart = 2;
// Every so many bytes are looked at. It is odd, so that all four bytes of floats are among them.
constexpr std::size_t kStride = 7;
// The entropy of a byte, in bits, above which a chunk is stored as it is.
constexpr double kMaxEntropy_bits = 6;

double entropy_bits(std::span<const std::uint8_t> numbers) {
  std::array<std::uint32_t, 256> counts{};
  double all = 0;
  for (std::size_t i = kApart; i < numbers.size(); i += kStride, ++all) {
    ++counts[static_cast<std::uint8_t>(numbers[i] - numbers[i - kApart])];
  }
  double bits = 0;
  for (const std::uint32_t count : counts) {
    if (count > 0) bits += count / all * std::log2(all / count);
  }
  return bits;
}

// What EXR compresses: the even bytes, then the odd ones, each as its difference to the one before, plus 128.
std::vector<std::uint8_t> predicted(std::span<const std::uint8_t> numbers) {
  std::vector<std::uint8_t> bytes(numbers.size());
  const std::size_t even = (numbers.size() + 1) / 2;
  for (std::size_t i = 0; i < numbers.size(); ++i) bytes[(i % 2 == 0 ? 0 : even) + i / 2] = numbers[i];
  std::uint8_t before = bytes[0];
  for (std::size_t i = 1; i < bytes.size(); ++i) {
    const std::uint8_t now = bytes[i];
    bytes[i] = static_cast<std::uint8_t>(now - before + 128);
    before = now;
  }
  return bytes;
}

template <typename T>
void write_number(T number, char* to) {
  static_assert(std::endian::native == std::endian::little, "EXR is little-endian");
  std::memcpy(to, &number, sizeof number);
}

/// Appends the data of one chunk. The format lets a chunk be stored as it is if compression does not make it smaller.
/// Here that is done already where compression would save less than a quarter: the low bits of rendered floats are
/// noise, on which a compressor takes most of its time.
void append_data(std::span<const std::uint8_t> numbers, Deflater& deflater, std::string& file) {
  if (entropy_bits(numbers) <= kMaxEntropy_bits) {
    const std::string compressed = deflater.zlib_of(predicted(numbers));
    if (compressed.size() < numbers.size()) {
      file += compressed;
      return;
    }
  }
  append_binary_all(file, numbers);
}

// A chunk begins with its first row and the size of its data.
constexpr std::size_t kChunkFront = 2 * sizeof(std::int32_t);

std::string encode(ExrImage image, const ImageOrigin& origin) {
  std::ranges::sort(image.channels, {}, &NamedChannel::name);
  const std::size_t height = image.height;
  try {
    std::string file = front_of(image, origin);
    Deflater deflater;
    const std::size_t count = (height + kChunkRows - 1) / kChunkRows, table = file.size();
    file.reserve(table + count * (sizeof(std::uint64_t) + kChunkFront) +
                 image.width * height * image.channels.size() * kNumberBytes);  // the most that it can have
    file.resize(table + count * sizeof(std::uint64_t));
    std::vector<std::uint8_t> numbers;
    for (std::size_t chunk = 0; chunk < count; ++chunk) {
      const std::size_t y = chunk * kChunkRows, front = file.size();
      write_number(std::uint64_t{front}, &file[table + chunk * sizeof(std::uint64_t)]);
      file.resize(front + kChunkFront);
      gather(image, y, std::min(kChunkRows, height - y), numbers);
      append_data(numbers, deflater, file);
      write_number(static_cast<std::int32_t>(y), &file[front]);
      write_number(static_cast<std::int32_t>(file.size() - front - kChunkFront), &file[front + sizeof(std::int32_t)]);
    }
    return file;
  } catch (const Iex::BaseExc& error) {
    throw MachineError(std::string("an EXR picture cannot be encoded: ") + error.what());
  }
}

}  // namespace

std::string encode_exr(const Image* color, const Image* depth, const ImageOrigin& origin) {
  SIMVIS_ASSERT(color != nullptr || depth != nullptr);
  SIMVIS_ASSERT(color == nullptr || depth == nullptr ||
                (depth->width == color->width && depth->height == color->height));
  const Image& size = color != nullptr ? *color : *depth;
  ExrImage image{size.width, size.height, {}};
  if (color != nullptr) {
    image.add("R", *color, 0);
    image.add("G", *color, 1);
    image.add("B", *color, 2);
  }
  if (depth != nullptr) image.add("Z", *depth, 0);
  return encode(std::move(image), origin);
}

bool fits_exr(const MeasuredArray& image) {
  return image.value_type == ValueType::f32 || image.value_type == ValueType::u32 || image.value_type == ValueType::u8;
}

std::string encode_exr(const MeasuredArray& image, const ImageOrigin& origin) {
  SIMVIS_ASSERT(fits_exr(image));
  ExrImage exr{image.shape.columns, image.shape.rows, {}};
  std::vector<std::uint32_t> widened;
  const auto* const narrow = std::get_if<SharedArray<std::uint8_t>>(&image.numbers);
  if (narrow != nullptr) widened.assign(narrow->begin(), narrow->end());
  const auto* const floats = std::get_if<SharedArray<float>>(&image.numbers);
  const auto* const integers = std::get_if<SharedArray<std::uint32_t>>(&image.numbers);
  const void* const numbers = floats != nullptr     ? static_cast<const void*>(floats->data())
                              : integers != nullptr ? integers->data()
                                                    : widened.data();
  const auto* const first = static_cast<const std::byte*>(numbers);
  for (std::uint32_t channel = 0; channel < image.shape.channels; ++channel) {
    exr.channels.push_back({channel_name(image, channel), floats != nullptr ? Imf::FLOAT : Imf::UINT,
                            first + channel * kNumberBytes, image.shape.channels * kNumberBytes});
  }
  return encode(std::move(exr), origin);
}

namespace {

const FormatRegistration kColorExrFormat(
    {.kind = "color", .name = "exr", .file = "CAMERA/000000.exr", .text = "32-bit floats R G B (linear)", .order = 30}),
    kDepthExrFormat(
        {.kind = "depth",
         .name = "exr",
         .file = "CAMERA/000000.exr",
         .text = "of cameras whose `outputs` has depth: 32-bit floats Z (metres along the optical axis, `inf` "
                 "where nothing is hit), with the colour R G B (linear) unless a format of colour is chosen",
         .order = 0,
         .is_default = true});

}  // namespace

}  // namespace simvis
