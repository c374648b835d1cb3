#include "import/mesh/height_picture.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <stb_image.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <memory>
#include <new>
#include <stdexcept>

#include <simvis/location.h>
#include "engine/base/input_file.h"
#include "import/mesh/picture_file.h"
#include "import/mesh/stb_picture.h"
#include "scenegraph/shape_limits.h"

namespace simvis {
namespace {

constexpr std::uint8_t kExrStart[] = {0x76, 0x2f, 0x31, 0x01};
constexpr const char* kHeightChannels[] = {"Y", "Z", "R"};

[[noreturn]] void refuse_heights(const std::filesystem::path& file, const std::string& what) {
  fail_at({.file = file.string()}, "the picture of heights " + what);
}

void check_side(const std::filesystem::path& file, std::int64_t width, std::int64_t height) {
  for (const std::int64_t side : {width, height}) {
    if (side >= 2 && side <= std::int64_t{kMaxHeightsSide}) continue;
    refuse_heights(file, "has " + std::to_string(width) + " x " + std::to_string(height) +
                             " pixels, expected from 2 to " + std::to_string(kMaxHeightsSide) + " on a side");
  }
}

HeightPicture read_png_heights(const Bytes& bytes, const std::filesystem::path& file) {
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    refuse_heights(file, "has more than 2 GiB");
  }
  const int size = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  if (stbi_info_from_memory(bytes.data(), size, &width, &height, &channels) == 0) {
    refuse_heights(file, "has a broken header");
  }
  check_side(file, width, height);
  const std::unique_ptr<stbi_us, void (*)(void*)> grey(
      stbi_load_16_from_memory(bytes.data(), size, &width, &height, &channels, 1), stbi_image_free);
  if (grey == nullptr) throw_stb_failure(file.string() + ": error: the picture of heights");
  HeightPicture picture{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), {}};
  const std::size_t pixels = std::size_t{picture.width} * picture.height;
  picture.values.reserve(pixels);
  for (std::size_t i = 0; i < pixels; ++i) picture.values.push_back(static_cast<float>(grey.get()[i]) / 65535.0f);
  return picture;
}

// The bytes of a file, so that OpenEXR cannot take a disk that fails for a broken file.
class ExrBytes : public Imf::IStream {
 public:
  ExrBytes(const Bytes& bytes, const std::filesystem::path& file) : Imf::IStream(file.c_str()), bytes_(bytes) {}
  bool read(char out[], int count) override {
    const auto wanted = static_cast<std::size_t>(std::max(count, 0));
    if (at_ > bytes_.size() || wanted > bytes_.size() - at_) throw std::runtime_error("the file ends too early");
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(at_), wanted, out);
    at_ += wanted;
    return at_ < bytes_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t at) override { at_ = at; }

 private:
  const Bytes& bytes_;
  std::uint64_t at_ = 0;
};

HeightPicture decode_exr_heights(const Bytes& bytes, const std::filesystem::path& file) {
  ExrBytes stream(bytes, file);
  Imf::InputFile exr(stream, 1);
  const Imath::Box2i window = exr.header().dataWindow();
  check_side(file, std::int64_t{window.max.x} - window.min.x + 1, std::int64_t{window.max.y} - window.min.y + 1);
  HeightPicture picture{static_cast<std::uint32_t>(window.max.x - window.min.x + 1),
                        static_cast<std::uint32_t>(window.max.y - window.min.y + 1),
                        {}};
  const char* found = nullptr;
  for (const char* const name : kHeightChannels) {
    const Imf::Channel* const channel = exr.header().channels().findChannel(name);
    if (found == nullptr && channel != nullptr && channel->xSampling == 1 && channel->ySampling == 1) found = name;
  }
  if (found == nullptr) refuse_heights(file, "has none of the channels Y, Z and R");
  picture.values.resize(std::size_t{picture.width} * picture.height);
  Imf::FrameBuffer pixels;
  pixels.insert(
      found, Imf::Slice::Make(Imf::FLOAT, picture.values.data(), window, sizeof(float), sizeof(float) * picture.width));
  exr.setFrameBuffer(pixels);
  exr.readPixels(window.min.y, window.max.y);
  return picture;
}

HeightPicture read_exr_heights(const Bytes& bytes, const std::filesystem::path& file) {
  HeightPicture picture;
  try {
    picture = decode_exr_heights(bytes, file);
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;  // says nothing about the file
  } catch (const std::exception& error) {
    refuse_heights(file, std::string("cannot be decoded: ") + error.what());
  }
  for (const float value : picture.values) {
    if (!(std::abs(value) <= kMaxShapeLength_m)) refuse_heights(file, "has a value that is not finite or beyond 10^6");
  }
  return picture;
}

const PictureReaderRegistration kPictureReader({.texture = read_picture_file, .heights = read_height_picture});

}  // namespace

HeightPicture read_height_picture(const std::filesystem::path& file) {
  const Bytes bytes = read_whole_file(file);
  if (bytes.size() >= 4 && std::equal(kExrStart, kExrStart + 4, bytes.begin())) return read_exr_heights(bytes, file);
  if (!is_png_or_jpeg(bytes)) refuse_heights(file, "is of another kind, expected PNG or EXR");
  return read_png_heights(bytes, file);
}

}  // namespace simvis
