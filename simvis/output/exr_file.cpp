#include "simvis/output/exr_file.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfOutputFile.h>

#include <cstring>
#include <exception>
#include <span>
#include <vector>

#include <simvis/error.h>
#include "engine/base/assert.h"

namespace simvis {

namespace {

/// An OpenEXR output stream into memory, so that one place writes all files and handles their errors.
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

/// One channel of a file and the source of its values.
struct NamedChannel {
  const char* name;
  const Image* image;
  std::size_t channel;
};

void add_channel(const NamedChannel& from, Imf::Header& header, Imf::FrameBuffer& pixels) {
  const Image& image = *from.image;
  SIMVIS_ASSERT(image.pixels.size() == std::size_t{image.width} * image.height * image.channels);
  const std::size_t stride = sizeof(float) * image.channels;
  // OpenEXR takes a non-const pointer but does not change the data.
  auto* const first = const_cast<char*>(reinterpret_cast<const char*>(image.pixels.data() + from.channel));
  header.channels().insert(from.name, Imf::Channel(Imf::FLOAT));
  pixels.insert(from.name, Imf::Slice(Imf::FLOAT, first, stride, stride * image.width));
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

std::string encode(std::span<const NamedChannel> channels, const ImageOrigin& origin) {
  const Image& size = *channels.front().image;
  try {
    Imf::Header header(static_cast<int>(size.width), static_cast<int>(size.height));
    header.compression() = Imf::ZIP_COMPRESSION;
    header.zipCompressionLevel() = 1;  // higher levels barely reduce the size of float images
    add_origin(origin, header);
    Imf::FrameBuffer pixels;
    for (const NamedChannel& each : channels) add_channel(each, header, pixels);
    MemoryStream stream;
    {
      // The destructor of OutputFile writes the table of lines.
      Imf::OutputFile file(stream, header, 0);
      file.setFrameBuffer(pixels);
      file.writePixels(static_cast<int>(size.height));
    }
    return stream.take();
  } catch (const std::exception& error) {
    throw MachineError(std::string("an EXR picture cannot be encoded: ") + error.what());
  }
}

}  // namespace

std::string encode_exr(const Image* color, const Image* depth, const ImageOrigin& origin) {
  SIMVIS_ASSERT(color != nullptr || depth != nullptr);
  SIMVIS_ASSERT(color == nullptr || depth == nullptr ||
                (depth->width == color->width && depth->height == color->height));
  std::vector<NamedChannel> channels;
  if (color != nullptr) channels = {{"R", color, 0}, {"G", color, 1}, {"B", color, 2}};
  if (depth != nullptr) channels.push_back({"Z", depth, 0});
  return encode(channels, origin);
}

std::string encode_exr_plane(const std::string& channel, const Image& plane, const ImageOrigin& origin) {
  SIMVIS_ASSERT(plane.channels == 1);
  const NamedChannel channels[] = {{channel.c_str(), &plane, 0}};
  return encode(channels, origin);
}

}  // namespace simvis
