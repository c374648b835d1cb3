// Pictures of part files: where they are found, which kinds are read, and what stands in for those that are not there.
#include <doctest/doctest.h>
#include <tiffio.h>
#include <webp/encode.h>
#include <tiffio.hxx>

#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "import/mesh/picture_file.h"
#include "import/mesh/picture_search.h"
#include "scenegraph/pictures/png_file.h"
#include "tests/support/error_of.h"
#include "tests/support/parts/box_files.h"
#include "tests/support/parts/gltf_fixture.h"
#include "tests/support/parts/inventor_fixture.h"
#include "tests/support/random_numbers.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

namespace {

// Two pixels beside each other: red, and half transparent blue.
const ByteString kTwoPixels{255, 0, 0, 255, 0, 0, 255, 128};
const ByteString kTwoOpaquePixels{255, 0, 0, 255, 0, 0, 255, 255};

ByteString bytes_of(const std::string& text) { return {text.begin(), text.end()}; }

ByteString tga_file() {
  return {0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 1, 0, 32, 0x28, 0, 0, 255, 255, 255, 0, 0, 128};
}

ByteString bmp_file() {
  ByteString file{'B', 'M'};
  for (const std::uint32_t word : {54u + 8u, 0u, 54u, 40u, 2u, 1u, 1u | 24u << 16, 0u, 8u, 0u, 0u, 0u, 0u}) {
    put_u32(file, word, false);
  }
  file.insert(file.end(), {0, 0, 255, 255, 0, 0, 0, 0});
  return file;
}

ByteString ppm_file() { return bytes_of(std::string("P6\n2 1\n255\n\xff\0\0\0\0\xff", 17)); }

ByteString webp_file() {
  std::uint8_t* encoded = nullptr;
  const std::size_t size = WebPEncodeLosslessRGBA(kTwoPixels.data(), 2, 1, 8, &encoded);
  ByteString bytes(encoded, encoded + size);
  WebPFree(encoded);
  return bytes;
}

ByteString tiff_file() {
  std::ostringstream stream;
  TIFF* const file = TIFFStreamOpen("made", &stream);
  TIFFSetField(file, TIFFTAG_IMAGEWIDTH, 2);
  TIFFSetField(file, TIFFTAG_IMAGELENGTH, 1);
  TIFFSetField(file, TIFFTAG_SAMPLESPERPIXEL, 4);
  TIFFSetField(file, TIFFTAG_BITSPERSAMPLE, 8);
  TIFFSetField(file, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_RGB);
  TIFFSetField(file, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(file, TIFFTAG_COMPRESSION, COMPRESSION_LZW);
  const std::uint16_t extra = EXTRASAMPLE_UNASSALPHA;
  TIFFSetField(file, TIFFTAG_EXTRASAMPLES, 1, &extra);
  ByteString row = kTwoPixels;
  TIFFWriteScanline(file, row.data(), 0, 0);
  TIFFClose(file);
  return bytes_of(stream.str());
}

// The box as OBJ, red, with a picture of this name.
std::filesystem::path box_with_picture(const std::filesystem::path& folder, const std::string& name) {
  write_text(folder / "box.mtl", "newmtl m\nKd 1 0 0\nmap_Kd " + name + "\n");
  write_text(folder / "box.obj", "mtllib box.mtl\nusemtl m\n" + obj_box());
  return folder / "box.obj";
}

const Material& material_of(const Loaded& loaded) { return *loaded.list.materials.at(0); }

std::filesystem::path made_folder(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  return folder;
}

}  // namespace

TEST_CASE("every kind of picture that a packaged library reads") {
  CHECK(decode_picture(tga_file(), "x").rgba == kTwoPixels);
  CHECK(decode_picture(bmp_file(), "x").rgba == kTwoOpaquePixels);
  CHECK(decode_picture(ppm_file(), "x").rgba == kTwoOpaquePixels);
  CHECK(decode_picture(webp_file(), "x").rgba == kTwoPixels);
  CHECK(decode_picture(tiff_file(), "x").rgba == kTwoPixels);
  CHECK(decode_picture(webp_file(), "x").width == 2);
  for (const auto& [bytes, kind] : {std::pair("DDS |", "DDS"), std::pair("\xABKTX 20\xBB", "KTX 2")}) {
    const std::string error = error_of([&] { decode_picture(bytes_of(bytes), "a.dae: error: the picture"); });
    CHECK(contains(error, "a.dae: error: the picture is a picture of the kind " + std::string(kind)));
    CHECK(contains(error, "expected PNG, JPEG, TGA"));
  }
  CHECK(contains(error_of([] { decode_picture(bytes_of("<svg/>"), "x"); }), "x is of no known kind"));
  CHECK(contains(error_of([] { decode_picture({}, "x"); }), "x is of no known kind"));
}

TEST_CASE("pictures that end too early are refused, whichever byte is the last") {
  // A row of 300 pixels is read at once, rows of two byte by byte.
  ByteString wide = tga_file();
  wide[12] = 300 & 255, wide[13] = 300 >> 8;
  wide.resize(18 + 4 * 300, 7);
  CHECK(decode_picture(wide, "x").rgba.back() == 7);
  const ByteString hdr = bytes_of("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\x80\x80\x80\x80\x40\x40\x40\x80");
  CHECK(decode_picture(hdr, "x").width == 2);
  const std::size_t bmp_padding = 2;  // of its only row, which stb_image does not read
  for (const auto& [whole, unread] :
       {std::pair(wide, std::size_t{0}), {tga_file(), 0}, {hdr, 0}, {ppm_file(), 0}, {bmp_file(), bmp_padding}}) {
    for (const std::size_t lost : {1, 2, 4}) {
      CAPTURE(whole.size());
      CAPTURE(lost);
      const ByteString part(whole.begin(), whole.end() - static_cast<std::ptrdiff_t>(unread + lost));
      const std::string error = error_of([&] { decode_picture(part, "x"); });
      CHECK(contains(error, "x cannot be decoded: "));
    }
  }
}

TEST_CASE("a PNG whose chunks differ from their checksums is refused") {
  constexpr std::size_t kHeaderSum = 8 + 8 + 13;  // behind the start, the head of a chunk and the header's content
  const Image image{.width = 2, .height = 1, .channels = 4, .pixels = {1, 0, 0, 1, 0, 0, 1, 1}};
  const ByteString png = bytes_of(encode_png(image));
  CHECK(decode_picture(png, "x").rgba == kTwoOpaquePixels);
  for (const std::size_t at : {kHeaderSum, kHeaderSum + 3, png.size() - 14, png.size() - 1}) {
    ByteString damaged = png;
    damaged[at] ^= 1;
    CHECK(error_of([&] { decode_picture(damaged, "x"); }) == "x is broken: the checksum of a chunk of PNG differs");
  }
}

TEST_CASE("a JPEG without its end is refused, although its beginning could be shown") {
  const ByteString whole = bytes_of(read_text(std::filesystem::path(SIMVIS_SOURCE_DIR) / "scenes/arm/hand_cam.jpg"));
  CHECK(decode_picture(whole, "x").width > 100);
  for (const std::size_t kept : {whole.size() / 2, whole.size() - 2}) {
    const ByteString part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(kept));
    CHECK(contains(error_of([&] { decode_picture(part, "x"); }), "x cannot be decoded: "));
  }
}

TEST_CASE("broken pictures are refused or read, and crash nothing") {
  const int tries = 40;  // each in a process of its own
  Random random;
  for (const ByteString& seed : std::vector<ByteString>{tga_file(), bmp_file(), ppm_file(), webp_file(), tiff_file()}) {
    for (int i = 0; i < tries; ++i) {
      ByteString broken = seed;
      if (random.below(3) == 0) broken.resize(random.below(broken.size()));
      for (std::uint64_t flips = 1 + random.below(4); flips > 0 && !broken.empty(); --flips) {
        broken[random.below(broken.size())] ^= static_cast<std::uint8_t>(1u << random.below(8));
      }
      const std::string error = error_of([&] {
        const Texture texture = decode_picture(broken, "x");
        CHECK(texture.rgba.size() == std::size_t{4} * texture.width * texture.height);
      });
      CHECK_FALSE(error.empty());
    }
  }
  // A width of 65535: refused before memory is taken.
  ByteString wide = tga_file();
  wide[12] = wide[13] = 255;
  CHECK(contains(error_of([&] { decode_picture(wide, "x"); }), "x has 65535 x 1 pixels; expected at most 16384"));
}

TEST_CASE("pictures are found as written, as Gazebo finds them, by their last component, without regard to case") {
  TemporaryFolder folder;
  const std::filesystem::path meshes = made_folder(folder / "model/meshes");
  const auto search = [&](const std::string& name) { return find_picture(name, meshes / "box.obj"); };
  const auto found = [&](const std::string& name) {
    const PictureSearch result = search(name);
    REQUIRE_MESSAGE(result.file.has_value(), name);
    return read_text(*result.file) + (result.elsewhere ? " elsewhere" : "");
  };
  write_text(made_folder(meshes / "sub") / "a.png", "sub");
  CHECK(found("sub/a.png") == "sub");
  CHECK(found("sub\\a.png") == "sub");
  CHECK(found("SUB/A.png") == "sub elsewhere");
  CHECK(found("file://" + (meshes / "sub/a.png").string()) == "sub");
  CHECK_FALSE(search("a.png").file);
  write_text(meshes / "a.png", "beside");
  for (const char* name : {"C:\\art\\a.png", "file:///C:/art/a.png", "/nowhere/a.png", "gone/a.png", "//host/a.png"}) {
    CHECK(found(name) == "beside elsewhere");
  }
  CHECK(found("A.PNG") == "beside elsewhere");
  write_text(made_folder(folder / "model/materials/textures") / "a.png", "gazebo");
  CHECK(found("C:\\art\\a.png") == "gazebo");
  CHECK(found("a.png") == "beside");
  const PictureSearch missing = search("C:\\art\\b.png");
  CHECK_FALSE(missing.file);
  CHECK(contains(missing.not_found(), "model/meshes/../materials/textures/b.png"));
  CHECK(contains(missing.not_found(), "model/meshes/b.png"));
  for (const char* odd : {"", ".", "..", "/", "C:", "sub", "\\"}) CHECK_FALSE(search(odd).file);
}

TEST_CASE("a picture that is missing, broken or elsewhere: the colour and one warning") {
  TemporaryFolder folder;
  const Loaded missing = load(box_with_picture(folder.path(), "none.png\nnewmtl n\nmap_Kd -clamp on none.png"));
  check_box(missing.list);
  CHECK(material_of(missing).base_color == glm::vec4(1, 0, 0, 1));
  CHECK(material_of(missing).base_color_texture == nullptr);
  REQUIRE(missing.warnings.size() == 1);
  CHECK(
      contains(missing.warnings[0], "box.obj: picture \"none.png\" is not there; the material's colour replaces it; "));
  CHECK(contains(missing.warnings[0], "tried " + (folder / "none.png").string() + ", "));

  write_text(folder / "text.png", "no picture");
  const Loaded broken = load(box_with_picture(folder.path(), "text.png"));
  CHECK(material_of(broken).base_color_texture == nullptr);
  REQUIRE(broken.warnings.size() == 1);
  CHECK(contains(broken.warnings[0], "box.obj: picture \"text.png\": the material's colour replaces it, "));
  CHECK(contains(broken.warnings[0], "text.png: the picture is of no known kind"));

  write_bytes(folder / "there.tga", tga_file());
  const Loaded there = load(box_with_picture(folder.path(), "there.tga"));
  CHECK(there.warnings.empty());
  REQUIRE(material_of(there).base_color_texture != nullptr);
  CHECK(material_of(there).base_color_texture->rgba == kTwoPixels);

  const Loaded elsewhere = load(box_with_picture(folder.path(), "C:\\art\\There.TGA"));
  REQUIRE(elsewhere.warnings.size() == 1);
  CHECK(contains(elsewhere.warnings[0], "is taken from " + (folder / "there.tga").string()));
  CHECK(material_of(elsewhere).base_color_texture != nullptr);
}

TEST_CASE("a COLLADA material without its picture is white") {
  TemporaryFolder folder;
  const std::string dae = dae_box(kMetresZUp, 1, "", "<diffuse><texture texture=\"i\" texcoord=\"UV\"/></diffuse>");
  const std::size_t at = dae.find("<library_effects>");
  REQUIRE(at != std::string::npos);
  write_text(folder / "box.dae",
             std::string(dae).insert(at,
                                     "<library_images><image id=\"i\"><init_from>none.png</init_from></image>"
                                     "</library_images>"));
  const Loaded loaded = load(folder / "box.dae");
  check_box(loaded.list);
  CHECK(material_of(loaded).base_color == glm::vec4(1));
  REQUIRE(loaded.warnings.size() == 1);
  CHECK(contains(loaded.warnings[0], "box.dae: picture \"none.png\" is not there"));
}

TEST_CASE("Inventor and VRML find pictures in the same places") {
  if (!has_coin()) return;
  InventorFiles files;
  const std::string box = "geometry Box { } }";
  const auto vrml = [&](const std::string& name) {
    return files.vrml("Shape { appearance Appearance { material Material { } texture ImageTexture { url \"" + name +
                      "\" } } " + box);
  };
  const auto iv = [&](const std::string& name) { return files.iv("Texture2 { filename \"" + name + "\" } Cube { }"); };
  for (const LoadedPart& part : {iv("none.png"), vrml("none.png")}) {
    CHECK(test::material_of(part, 0).base_color_texture == nullptr);
    REQUIRE(part.content.warnings.size() == 1);
    CHECK(contains(part.content.warnings[0], ": picture \"none.png\" is not there; the material's colour replaces it"));
  }
  write_bytes(files.folder / "there.tga", tga_file());
  for (const LoadedPart& part : {iv("gone/There.tga"), vrml("C:/art/There.TGA")}) {
    REQUIRE(test::material_of(part, 0).base_color_texture != nullptr);
    CHECK(test::material_of(part, 0).base_color_texture->rgba == kTwoPixels);
    REQUIRE(part.content.warnings.size() == 1);
    CHECK(contains(part.content.warnings[0], "is taken from "));
  }
  write_text(files.folder / "text.png", "no picture");
  for (const LoadedPart& part : {iv("text.png"), vrml("text.png")}) {
    CHECK(test::material_of(part, 0).base_color_texture == nullptr);
    REQUIRE(part.content.warnings.size() == 1);
    CHECK(contains(part.content.warnings[0], "text.png: the picture is of no known kind"));
  }
}

TEST_SUITE_END();
