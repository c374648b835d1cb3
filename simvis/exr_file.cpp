#include "simvis/exr_file.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfOutputFile.h>

#include <cstring>
#include <exception>

#include "engine/assert.h"
#include "engine/error.h"

namespace simvis {

namespace {

/// OpenEXR's way to write, into memory: so that files are written, and their errors found, in one place.
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

void add_channel(const char* name, const Image& image, std::size_t channel, Imf::Header& header,
                 Imf::FrameBuffer& pixels) {
  SIMVIS_ASSERT(image.pixels.size() == std::size_t{image.width} * image.height * image.channels);
  const std::size_t stride = sizeof(float) * image.channels;
  // OpenEXR takes a pointer to what it does not change.
  auto* const first = const_cast<char*>(reinterpret_cast<const char*>(image.pixels.data() + channel));
  header.channels().insert(name, Imf::Channel(Imf::FLOAT));
  pixels.insert(name, Imf::Slice(Imf::FLOAT, first, stride, stride * image.width));
}

}  // namespace

std::string encode_exr(const Image* color, const Image* depth) {
  SIMVIS_ASSERT(color != nullptr || depth != nullptr);
  const Image& size = color != nullptr ? *color : *depth;
  SIMVIS_ASSERT(depth == nullptr || (depth->width == size.width && depth->height == size.height));
  try {
    Imf::Header header(static_cast<int>(size.width), static_cast<int>(size.height));
    header.compression() = Imf::ZIP_COMPRESSION;
    header.zipCompressionLevel() = 1;  // float pictures hardly shrink further
    Imf::FrameBuffer pixels;
    if (color != nullptr) {
      add_channel("R", *color, 0, header, pixels);
      add_channel("G", *color, 1, header, pixels);
      add_channel("B", *color, 2, header, pixels);
    }
    if (depth != nullptr) add_channel("Z", *depth, 0, header, pixels);
    MemoryStream stream;
    {
      // The table of lines is written when the file ends.
      Imf::OutputFile file(stream, header, 0);
      file.setFrameBuffer(pixels);
      file.writePixels(static_cast<int>(size.height));
    }
    return stream.take();
  } catch (const std::exception& error) {
    throw MachineError(std::string("an EXR picture cannot be encoded: ") + error.what());
  }
}

}  // namespace simvis
