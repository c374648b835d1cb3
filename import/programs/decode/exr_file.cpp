#include "import/programs/decode/exr_file.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>

#include <algorithm>
#include <cstddef>
#include <new>
#include <stdexcept>
#include <string>

#include <simvis/error.h>

namespace simvis {
namespace {

constexpr int kThreads = 1;

class ExrBytes : public Imf::IStream {
 public:
  explicit ExrBytes(std::span<const std::uint8_t> bytes) : Imf::IStream("the picture"), bytes_(bytes) {}
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
  std::span<const std::uint8_t> bytes_;
  std::uint64_t at_ = 0;
};

struct ExrSize {
  std::uint32_t width, height;
};

// Throws InputError if the size is refused.
ExrSize size_of(const Imf::InputFile& exr, std::string (*refusal_of)(std::int64_t, std::int64_t)) {
  const Imath::Box2i window = exr.header().dataWindow();
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1,
                     height = std::int64_t{window.max.y} - window.min.y + 1;
  if (const std::string refusal = refusal_of(width, height); !refusal.empty()) throw InputError(refusal);
  return {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
}

// Whether each pixel has a value of its own.
bool has_channel(const Imf::InputFile& exr, const char* name) {
  const Imf::Channel* const channel = exr.header().channels().findChannel(name);
  return channel != nullptr && channel->xSampling == 1 && channel->ySampling == 1;
}

// Reads a channel into every `stride`-th number from `values` on.
void add_slice(Imf::FrameBuffer& pixels, const Imf::InputFile& exr, const char* name, float* values,
               std::uint32_t width, std::size_t stride) {
  pixels.insert(name, Imf::Slice::Make(Imf::FLOAT, values, exr.header().dataWindow(), stride * sizeof(float),
                                       stride * sizeof(float) * width));
}

void read(Imf::InputFile& exr, const Imf::FrameBuffer& pixels) {
  exr.setFrameBuffer(pixels);
  exr.readPixels(exr.header().dataWindow().min.y, exr.header().dataWindow().max.y);
}

HeightPicture heights_of(Imf::InputFile& exr) {
  const auto [width, height] = size_of(exr, refusal_of_heights);
  HeightPicture picture{width, height, {}};
  const char* found = nullptr;
  for (const char* const name : {"Y", "Z", "R"}) {
    if (found == nullptr && has_channel(exr, name)) found = name;
  }
  if (found == nullptr) throw InputError("has none of the channels Y, Z and R");
  picture.values.resize(std::size_t{width} * height);
  Imf::FrameBuffer pixels;
  add_slice(pixels, exr, found, picture.values.data(), width, 1);
  read(exr, pixels);
  return picture;
}

SkyPicture sky_of(Imf::InputFile& exr) {
  const auto [width, height] = size_of(exr, refusal_of_sky);
  SkyPicture picture{width, height, {}};
  constexpr const char* kColors[] = {"R", "G", "B"};
  const bool is_colored = std::ranges::all_of(kColors, [&](const char* name) { return has_channel(exr, name); });
  if (!is_colored && !has_channel(exr, "Y")) throw InputError("has neither the channels R, G and B nor Y");
  picture.radiance.resize(std::size_t{width} * height);
  Imf::FrameBuffer pixels;
  for (int i = 0; i < (is_colored ? 3 : 1); ++i) {
    add_slice(pixels, exr, is_colored ? kColors[i] : "Y", &picture.radiance[0][i], width, 3);
  }
  read(exr, pixels);
  if (!is_colored) {
    for (glm::vec3& each : picture.radiance) each = glm::vec3(each.r);
  }
  return picture;
}

template <class Read>
auto decode(std::span<const std::uint8_t> bytes, Read read_picture) {
  try {
    ExrBytes stream(bytes);
    Imf::InputFile exr(stream, kThreads);
    return read_picture(exr);
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;  // says nothing about the file
  } catch (const std::exception& error) {
    throw InputError(std::string("cannot be decoded: ") + error.what());
  }
}

}  // namespace

HeightPicture decode_exr_heights(std::span<const std::uint8_t> bytes) { return decode(bytes, heights_of); }

SkyPicture decode_exr_sky(std::span<const std::uint8_t> bytes) { return decode(bytes, sky_of); }

}  // namespace simvis
