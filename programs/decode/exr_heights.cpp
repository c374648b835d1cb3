#include "programs/decode/exr_heights.h"

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

constexpr const char* kHeightChannels[] = {"Y", "Z", "R"};

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

HeightPicture decode(std::span<const std::uint8_t> bytes) {
  ExrBytes stream(bytes);
  constexpr int kThreads = 1;
  Imf::InputFile exr(stream, kThreads);
  const Imath::Box2i window = exr.header().dataWindow();
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1,
                     height = std::int64_t{window.max.y} - window.min.y + 1;
  if (const std::string refusal = refusal_of_heights(width, height); !refusal.empty()) throw InputError(refusal);
  HeightPicture picture{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), {}};
  const char* found = nullptr;
  for (const char* const name : kHeightChannels) {
    const Imf::Channel* const channel = exr.header().channels().findChannel(name);
    if (found == nullptr && channel != nullptr && channel->xSampling == 1 && channel->ySampling == 1) found = name;
  }
  if (found == nullptr) throw InputError("has none of the channels Y, Z and R");
  picture.values.resize(std::size_t{picture.width} * picture.height);
  Imf::FrameBuffer pixels;
  pixels.insert(
      found, Imf::Slice::Make(Imf::FLOAT, picture.values.data(), window, sizeof(float), sizeof(float) * picture.width));
  exr.setFrameBuffer(pixels);
  exr.readPixels(window.min.y, window.max.y);
  return picture;
}

}  // namespace

HeightPicture decode_exr_heights(std::span<const std::uint8_t> bytes) {
  try {
    return decode(bytes);
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;  // says nothing about the file
  } catch (const std::exception& error) {
    throw InputError(std::string("cannot be decoded: ") + error.what());
  }
}

}  // namespace simvis
