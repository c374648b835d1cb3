// Reads back the pictures that SimVis writes.
#pragma once

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#define STBI_ONLY_PNG
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_image.h>
#pragma GCC diagnostic pop

namespace simvis {

struct PngPicture {
  int width = 0, height = 0, channels = 0;
  std::vector<std::uint8_t> pixels;
};

inline PngPicture read_png(const std::filesystem::path& file) {
  PngPicture png;
  stbi_uc* const data = stbi_load(file.c_str(), &png.width, &png.height, &png.channels, 0);
  if (data == nullptr) throw std::runtime_error(file.string() + ": " + stbi_failure_reason());
  png.pixels.assign(data, data + png.width * png.height * png.channels);
  stbi_image_free(data);
  return png;
}

struct ExrPicture {
  int width = 0, height = 0;
  Imf::Compression compression{};
  std::map<std::string, std::vector<float>> channels;
  std::map<std::string, std::vector<std::uint32_t>> integers;  // of channels that are not float32
};

inline ExrPicture read_exr(const std::filesystem::path& path) {
  Imf::InputFile file(path.c_str());
  const Imf::Header& header = file.header();
  ExrPicture exr;
  exr.width = header.dataWindow().max.x + 1;
  exr.height = header.dataWindow().max.y + 1;
  exr.compression = header.compression();
  Imf::FrameBuffer buffer;
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
    const Imf::PixelType type = channel.channel().type;
    if (type == Imf::HALF) throw std::runtime_error("a channel of float16");
    const auto read_to = [&](auto& pixels) {
      pixels.resize(static_cast<std::size_t>(exr.width) * static_cast<std::size_t>(exr.height));
      buffer.insert(channel.name(), Imf::Slice(type, reinterpret_cast<char*>(pixels.data()), sizeof(float),
                                               sizeof(float) * static_cast<std::size_t>(exr.width)));
    };
    if (type == Imf::FLOAT) {
      read_to(exr.channels[channel.name()]);
    } else {
      read_to(exr.integers[channel.name()]);
    }
  }
  file.setFrameBuffer(buffer);
  file.readPixels(0, exr.height - 1);
  return exr;
}

}  // namespace simvis
