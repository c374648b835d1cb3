#include "import/programs/decode/any_picture.h"

#include <tiffio.h>
#include <webp/decode.h>
#include <tiffio.hxx>

#include <algorithm>
#include <memory>
#include <sstream>
#include <string_view>
#include <vector>

#include <simvis/error.h>
#include "import/mesh/stb_picture.h"
#include "import/programs/decode/pnm_picture.h"

namespace simvis {
namespace {

Texture texture_of_size(std::uint32_t width, std::uint32_t height) {
  Texture texture;
  texture.width = width;
  texture.height = height;
  texture.rgba.resize(std::size_t{4} * width * height);
  return texture;
}

Texture decode_webp(std::span<const std::uint8_t> bytes, const std::string& subject) {
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(bytes.data(), bytes.size(), &features) != VP8_STATUS_OK) {
    throw InputError(subject + " has a broken header");
  }
  if (features.has_animation != 0) throw InputError(subject + " is an animated WebP");
  check_picture_size(features.width, features.height, subject);
  Texture texture =
      texture_of_size(static_cast<std::uint32_t>(features.width), static_cast<std::uint32_t>(features.height));
  if (WebPDecodeRGBAInto(bytes.data(), bytes.size(), texture.rgba.data(), texture.rgba.size(), 4 * features.width) ==
      nullptr) {
    throw InputError(subject + " cannot be decoded: broken WebP");
  }
  return texture;
}

// libtiff multiplies the colours by alpha.
std::uint8_t without_alpha(unsigned color, unsigned alpha) {
  return static_cast<std::uint8_t>(alpha == 0 ? 0u : std::min(255u, (color * 255 + alpha / 2) / alpha));
}

Texture decode_tiff(std::span<const std::uint8_t> bytes, const std::string& subject) {
  TIFFSetErrorHandler(nullptr);
  TIFFSetWarningHandler(nullptr);
  std::istringstream stream(std::string(bytes.begin(), bytes.end()));
  const std::unique_ptr<TIFF, void (*)(TIFF*)> tiff(TIFFStreamOpen("picture", &stream), TIFFClose);
  std::uint32_t width = 0, height = 0;
  if (tiff == nullptr || TIFFGetField(tiff.get(), TIFFTAG_IMAGEWIDTH, &width) != 1 ||
      TIFFGetField(tiff.get(), TIFFTAG_IMAGELENGTH, &height) != 1) {
    throw InputError(subject + " has a broken header");
  }
  check_picture_size(width, height, subject);
  char why[1024] = "";
  if (TIFFRGBAImageOK(tiff.get(), why) == 0) throw InputError(subject + " is a TIFF that cannot be read: " + why);
  std::vector<std::uint32_t> pixels(std::size_t{width} * height);
  constexpr int kStopOnError = 1;
  if (TIFFReadRGBAImageOriented(tiff.get(), width, height, pixels.data(), ORIENTATION_TOPLEFT, kStopOnError) == 0) {
    throw InputError(subject + " cannot be decoded: broken TIFF");
  }
  Texture texture = texture_of_size(width, height);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const std::uint32_t pixel = pixels[i], alpha = TIFFGetA(pixel);
    texture.rgba[4 * i] = without_alpha(TIFFGetR(pixel), alpha);
    texture.rgba[4 * i + 1] = without_alpha(TIFFGetG(pixel), alpha);
    texture.rgba[4 * i + 2] = without_alpha(TIFFGetB(pixel), alpha);
    texture.rgba[4 * i + 3] = static_cast<std::uint8_t>(alpha);
  }
  return texture;
}

// The kinds that people use for textures and that no packaged library reads.
const char* unreadable_kind(std::string_view bytes) {
  using namespace std::string_view_literals;
  if (bytes.starts_with("DDS ")) return "DDS";
  if (bytes.starts_with("\xABKTX 11\xBB"sv)) return "KTX";
  if (bytes.starts_with("\xABKTX 20\xBB"sv)) return "KTX 2";
  if (bytes.starts_with("\x76\x2F\x31\x01"sv)) return "OpenEXR";
  return nullptr;
}

}  // namespace

Texture decode_any_picture(std::span<const std::uint8_t> bytes, const std::string& subject) {
  using namespace std::string_view_literals;
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (const char* const kind = unreadable_kind(text)) {
    throw InputError(subject + " is a picture of the kind " + kind +
                     ", which cannot be read; expected PNG, JPEG, TGA, BMP, PSD, GIF, HDR, PNM, TIFF or WebP");
  }
  if (text.starts_with("RIFF") && text.substr(0, 12).ends_with("WEBP")) return decode_webp(bytes, subject);
  if (text.starts_with("II*\0"sv) || text.starts_with("MM\0*"sv)) return decode_tiff(bytes, subject);
  if (is_pnm(bytes)) return decode_pnm(bytes, subject);
  return decode_with_stb(bytes, subject);
}

}  // namespace simvis
