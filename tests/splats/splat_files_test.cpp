// Files of Gaussian splats as parts: what they say, and what is refused.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "engine/draw/splat_cloud.h"
#include "scenegraph/flattener.h"
#include "simvis/scene_builder.h"
#include "tests/support/error_of.h"
#include "tests/support/splat_file.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("engine/splats");

namespace simvis {
namespace {

using test::FileSplat;
using test::splat_file;
using test::splat_header;
using test::splat_numbers;

// A part of a file in a folder of its own.
class SplatPart {
 public:
  explicit SplatPart(const std::string& bytes, const std::string& attributes = "", const std::string& name = "s.ply") {
    write_text(folder_ / name, bytes);
    built_ = build_scene(parse_commands("<part file='" + name + "' name='S' insert_at='ROOT' " + attributes + "/>",
                                        "s.xml", folder_.path()));
    flattener_ = std::make_unique<Flattener>(built_.scene.root());
  }
  const DrawList& list() { return flattener_->update(); }
  const SplatCloud& cloud() {
    REQUIRE(list().meshes.size() == 1);
    REQUIRE(list().meshes[0]->splats != nullptr);
    return *list().meshes[0]->splats;
  }
  std::vector<std::string> warnings() const {
    const auto& of_scene = built_.scene.warnings();
    return {of_scene.begin(), of_scene.end()};
  }

 private:
  TemporaryFolder folder_;
  BuiltScene built_;
  std::unique_ptr<Flattener> flattener_;
};

std::string refusal(const std::string& bytes) {
  return error_of([&] { SplatPart{bytes}; });
}

std::string binary(const std::vector<double>& numbers, bool big_endian) {
  std::string bytes;
  for (const double number : numbers) {
    const auto value = static_cast<float>(number);
    std::string of_one(reinterpret_cast<const char*>(&value), sizeof value);
    if (big_endian) std::ranges::reverse(of_one);
    bytes += of_one;
  }
  return bytes;
}

const FileSplat kSplat{.center_m = {1, 2, -3},
                       .sigma_m = {0.1, 0.02, 0.5},
                       .rotation = {0.5, -0.5, 0.5, 0.5},
                       .opacity = 0.75,
                       .color = {1, 0.25, 0}};

std::string committed(const std::string& name) {
  return read_text(std::filesystem::path(SIMVIS_SOURCE_DIR) / "tests/fuzz/corpora" / name);
}

// The committed file of two splats, with a part of its text changed.
std::string splat_gltf(const std::string& from = "", const std::string& to = "") {
  std::string text = committed("gltf/splats.gltf");
  if (from.empty()) return text;
  const std::size_t at = text.find(from);
  REQUIRE(at != text.npos);
  return text.replace(at, from.size(), to);
}

void check_is_splat(const SplatCloud& cloud) {
  // Logarithms and logits are float32 in a binary file: 3 times 2^-24 times the value.
  constexpr double kRelative = 3e-7;
  REQUIRE(cloud.splats.size() == 1);
  const Splat& splat = cloud.splats[0];
  CHECK(splat.center == glm::vec3(1, 2, -3));
  for (int i = 0; i < 3; ++i) CHECK(splat.sigma[i] == doctest::Approx(kSplat.sigma_m[i]).epsilon(kRelative));
  CHECK(splat.rotation == glm::vec4(0.5, -0.5, 0.5, 0.5));
  CHECK(splat.opacity == doctest::Approx(0.75).epsilon(kRelative));
  const glm::dvec3 color = splat_color(std::span(cloud.harmonics).first(1), {0, 0, 1});
  for (int i = 0; i < 3; ++i) CHECK(std::abs(color[i] - kSplat.color[i]) < kRelative);
}

}  // namespace

TEST_CASE("PLY in text and in both binary forms: splats with the values of the file") {
  SplatPart text(splat_file({kSplat}));
  CHECK(text.cloud().degree == 0);
  check_is_splat(text.cloud());
  CHECK(text.warnings().empty());
  const auto numbers = splat_numbers(kSplat);
  for (const bool big : {false, true}) {
    CAPTURE(big);
    SplatPart part(splat_header(1, 0, big ? "binary_big_endian" : "binary_little_endian") +
                   binary({numbers.begin(), numbers.end()}, big));
    check_is_splat(part.cloud());
  }
  CHECK(text.list().meshes[0]->positions.empty());
  CHECK(text.list().meshes[0]->indices.empty());
}

TEST_CASE("quaternions of any length are unit quaternions, and up turns the part") {
  FileSplat splat = kSplat;
  splat.rotation *= 7;
  SplatPart part(splat_file({splat}), "up='y'");
  CHECK(part.cloud().splats[0].rotation == glm::vec4(0.5, -0.5, 0.5, 0.5));
  const DrawList& list = part.list();
  const glm::dvec3 up(list.world_from_node[list.items[0].transform] * glm::dvec4(0, 1, 0, 0));
  CHECK(up == glm::dvec3(0, 0, 1));
}

TEST_CASE("harmonics of degree 1: all of red, then of green, then of blue") {
  auto numbers = splat_numbers(kSplat);
  std::vector<double> all(numbers.begin(), numbers.begin() + 9);
  for (int i = 1; i <= 9; ++i) all.push_back(i);
  all.insert(all.end(), numbers.begin() + 9, numbers.end());
  SplatPart part(splat_header(1, 9, "binary_little_endian") + binary(all, false));
  const SplatCloud& cloud = part.cloud();
  CHECK(cloud.degree == 1);
  REQUIRE(cloud.harmonics.size() == 4);
  CHECK(cloud.harmonics[1] == glm::vec3(1, 4, 7));
  CHECK(cloud.harmonics[3] == glm::vec3(3, 6, 9));
}

TEST_CASE("splats that are none are left out with a warning, their harmonics too") {
  const auto numbers = splat_numbers(kSplat);
  std::vector<double> all;
  for (int i = 0; i < 6; ++i) {
    std::vector<double> of_one(numbers.begin(), numbers.end());
    if (i == 1) of_one[0] = std::numeric_limits<double>::quiet_NaN();
    if (i == 2) of_one[10] = 1e4;  // a standard deviation that is infinite
    if (i == 3) of_one[13] = of_one[14] = of_one[15] = of_one[16] = 0;
    if (i == 4) of_one[7] = std::numeric_limits<double>::infinity();
    if (i == 5) of_one[7] = 1e38;  // finite, but not in linear light
    all.insert(all.end(), of_one.begin(), of_one.end());
  }
  SplatPart part(splat_header(6, 0, "binary_little_endian") + binary(all, false));
  check_is_splat(part.cloud());
  CHECK(part.cloud().harmonics.size() == 1);
  REQUIRE(part.warnings().size() == 1);
  CHECK(contains(part.warnings()[0], "s.ply: 5 Gaussian splats are left out, which have numbers that are not finite"));
}

TEST_CASE("files that are broken are refused with a reason") {
  CHECK(contains(refusal(splat_header(0)), "s.ply: holds nothing to draw"));
  CHECK(contains(refusal(splat_header(4'000'001)), "s.ply: has 4000001 Gaussian splats, expected at most 4000000"));
  CHECK(contains(refusal(splat_header(2, 0, "binary_little_endian") + "short"), "ends too early"));
  std::string without = splat_file({kSplat});
  without.replace(without.find("scale_2"), 7, "scale_9");
  CHECK(contains(refusal(without), "s.ply: has Gaussian splats without the property \"scale_2\""));
  std::string odd = splat_header(1, 5);
  for (int i = 0; i < 22; ++i) odd += "1 ";
  CHECK(contains(refusal(odd + "\n"),
                 "has 5 properties \"f_rest_...\", expected 0, 9, 24 or 45: all spherical harmonics"));
}

// A compressed PLY of two splats in the limits of their chunk.
std::string packed_ply(const std::string& chunks = "1", const std::string& after_vertex = "") {
  std::string text = "ply\nformat binary_little_endian 1.0\ncomment by hand\nelement chunk " + chunks + "\n";
  for (const char* const kind : {"", "scale_", "color"}) {
    const bool is_color = std::string(kind) == "color";
    for (const char* const limit : {"min_", "max_"}) {
      for (const char axis : std::string(is_color ? "rgb" : "xyz")) {
        text += std::string("property float ") + limit + (is_color ? "" : kind) + axis + "\n";
      }
    }
  }
  text += "element vertex 2\n";
  for (const char* const name : {"position", "rotation", "scale", "color"}) {
    text += std::string("property uint packed_") + name + "\n";
  }
  text += after_vertex + "end_header\n";
  text += binary({-1, -2, -3, 1, 2, 3, -4, -5, -6, -1, -2, -3, 0, 0, 0, 1, 0.5, 2}, false);
  const auto add = [&](std::uint32_t number) {
    for (int i = 0; i < 4; ++i) text += static_cast<char>(number >> 8 * i & 255);
  };
  // All numbers least, and x as the largest of the rotation; all largest but y of the scale, and w.
  for (const std::uint32_t number : {0u, 1u << 30 | 1023u << 20 | 512u << 10 | 512u, 0u, 0u}) add(number);
  for (const std::uint32_t number : {~0u, 512u << 20 | 512u << 10 | 1023u, ~(1023u << 11), 0xff8000ffu}) add(number);
  return text;
}

TEST_CASE("compressed PLY of SuperSplat: splats between the limits of their chunk") {
  SplatPart part(packed_ply());
  const SplatCloud& cloud = part.cloud();
  CHECK(part.warnings().empty());
  CHECK(cloud.degree == 0);
  REQUIRE(cloud.splats.size() == 2);
  const Splat &first = cloud.splats[0], &second = cloud.splats[1];
  CHECK(first.center == glm::vec3(-1, -2, -3));
  CHECK(second.center == glm::vec3(1, 2, 3));
  CHECK(first.sigma == glm::vec3(std::exp(-4.0), std::exp(-5.0), std::exp(-6.0)));
  CHECK(second.sigma == glm::vec3(std::exp(-1.0), std::exp(-5.0), std::exp(-3.0)));
  CHECK(first.opacity == 0);
  CHECK(second.opacity == 1);
  // sqrt(1/2) in two numbers; 512 of 1023 is half a step of sqrt(2) / 1023 above 0, and two of them are in the rest.
  const double step = std::sqrt(2) / 1023, half = std::sqrt(0.5);
  CHECK(glm::length(glm::dvec4(first.rotation) - glm::dvec4(half, 0, 0, half)) < step);
  CHECK(glm::length(glm::dvec4(second.rotation) - glm::dvec4(0, 0, half, half)) < step);
  const auto color = [&](std::size_t i) { return splat_color(std::span(cloud.harmonics).subspan(i, 1), {0, 0, 1}); };
  constexpr double kFloat = 1e-7;  // of numbers up to 2: 2^-24
  CHECK(glm::length(color(0)) < 3 * kFloat);
  CHECK(glm::length(color(1) - glm::dvec3(1, 0.5 * 128 / 255, 0)) < 3 * kFloat);
}

TEST_CASE("compressed PLY that is broken is refused, and harmonics are left out with a warning") {
  CHECK(contains(refusal(packed_ply("2")), "s.ply: has 2 chunks, expected 1: one for each 256 splats"));
  const std::string whole = packed_ply();
  CHECK(contains(refusal(whole.substr(0, whole.size() - 1)), "s.ply: ends too early"));
  SplatPart part(packed_ply("1", "element sh 2\nproperty uchar f_rest_0\n") + "12");
  CHECK(part.cloud().splats.size() == 2);
  REQUIRE(part.warnings().size() == 1);
  CHECK(contains(part.warnings()[0], "s.ply: spherical harmonics of degree 1 and above are left out"));
}

TEST_CASE("the radius of points is for points") {
  SplatPart part(splat_file({kSplat}), "point_radius='0.1'");
  CHECK(part.cloud().splats.size() == 1);
  REQUIRE(part.warnings().size() == 1);
  CHECK(contains(part.warnings()[0], "holds no points, so that \"point_radius\" changes nothing"));
}

TEST_CASE("equal files are held once, and splats are part of what makes a list the same") {
  SplatPart a(splat_file({kSplat})), b(splat_file({kSplat}));
  FileSplat other = kSplat;
  other.opacity = 0.7;
  SplatPart c(splat_file({other}));
  CHECK(a.list().meshes[0] == b.list().meshes[0]);
  CHECK(same_content(a.list(), b.list()));
  CHECK_FALSE(same_content(a.list(), c.list()));
  CHECK(content_hash(a.list()) != content_hash(c.list()));
}

TEST_CASE("SPZ in its three versions") {
  for (const int version : {2, 3, 4}) {
    CAPTURE(version);
    const std::string bytes = committed("spz/version" + std::to_string(version) + ".spz");
    SplatPart part(bytes, "", "s.spz");
    const SplatCloud& cloud = part.cloud();
    CHECK(part.warnings().empty());
    REQUIRE(cloud.splats.size() == 2);
    const Splat &first = cloud.splats[0], &second = cloud.splats[1];
    CHECK(first.center == glm::vec3(1, 2, -3));
    CHECK(second.center == glm::vec3(-0.25, 0.5, 4));
    CHECK(first.sigma == glm::vec3(std::exp(-3.0), std::exp(-2.0), std::exp(-4.0)));
    CHECK(first.opacity == 191.0f / 255);
    CHECK(second.opacity == 1);
    // Half a step of three numbers of up to 0.5, from which the fourth one follows: as much as all three together.
    const double half_step = version == 2 ? 1 / 255.0 : 0.5 * std::sqrt(0.5) / 511, step = std::sqrt(12) * half_step;
    CHECK(glm::length(glm::dvec4(first.rotation) - glm::dvec4(0.5, -0.5, 0.5, 0.5)) < step);
    CHECK(glm::length(glm::dvec4(second.rotation) - glm::dvec4(0, 0, -0.6, 0.8)) < step);
    const std::size_t coefficients = version == 2 ? 1 : 4;
    REQUIRE(cloud.harmonics.size() == 2 * coefficients);
    constexpr double kColorScale = 0.15;
    for (int c = 0; c < 3; ++c) {
      const double byte = std::array{255, 64, 0}[static_cast<std::size_t>(c)];
      CHECK(cloud.harmonics[0][c] == static_cast<float>((byte / 255 - 0.5) / kColorScale));
    }
    if (version > 2) CHECK(cloud.harmonics[2] == glm::vec3(3, 4, 5) / 128.0f);
    const DrawList& list = part.list();
    CHECK(glm::dvec3(list.world_from_node[list.items[0].transform] * glm::dvec4(0, 1, 0, 0)) == glm::dvec3(0, 0, 1));
  }
}

TEST_CASE("SPZ that is broken is refused with a reason") {
  const auto refused = [](const std::string& bytes) { return error_of([&] { SplatPart(bytes, "", "s.spz"); }); };
  const std::string gzip = committed("spz/version3.spz"), zstd = committed("spz/version4.spz");
  CHECK(contains(refused("none"), "s.spz: is no SPZ file"));
  CHECK(contains(refused(std::string(40, 'x')), "s.spz: is no SPZ file"));
  CHECK(contains(refused(gzip.substr(0, gzip.size() - 20)), "s.spz: is broken, or ends too early"));
  for (std::size_t end = 1; end <= 8; ++end) {  // checksum and size of gzip, damaged and cut off
    std::string damaged = gzip;
    damaged[gzip.size() - end] ^= 1;
    CHECK(contains(refused(damaged), "s.spz: is broken: it ends too early, or its checksum differs"));
    CHECK(contains(refused(gzip.substr(0, gzip.size() - end)), "s.spz: is broken: it ends too early"));
  }
  CHECK(contains(refused(zstd.substr(0, zstd.size() - 1)), "s.spz: has a directory that does not fit"));
  CHECK(contains(refused(zstd.substr(0, 40)), "s.spz: ends within its directory"));
  const auto with = [&](std::size_t at, char value) {
    std::string changed = zstd;
    changed[at] = value;
    return refused(changed);
  };
  CHECK(contains(with(4, 5), "has the version 5, expected 2 to 4"));
  CHECK(contains(with(11, 1), "has 16777218 Gaussian splats, expected at most 4000000"));
  CHECK(contains(with(12, 4), "has spherical harmonics of degree 4, expected at most 3"));
  CHECK(contains(with(13, 60), "has places of more fractional bits than 24"));
  CHECK(contains(with(15, 5), "has fewer kinds of numbers than its splats need"));
  CHECK(contains(with(12, 3), "has a directory that does not fit"));
  CHECK(contains(with(130, 'x'), "is broken"));
}

TEST_CASE("glTF: splats with the attributes of KHR_gaussian_splatting") {
  SplatPart part(splat_gltf(), "", "s.gltf");
  const SplatCloud& cloud = part.cloud();
  CHECK(part.warnings().empty());
  CHECK(cloud.encoding == SplatEncoding::srgb);
  CHECK(cloud.degree == 0);
  REQUIRE(cloud.splats.size() == 2);
  CHECK(cloud.splats[0] == Splat{.center = {0, 0, 0}, .sigma = {0.1f, 0.2f, 0.3f}, .opacity = 0.5f});
  CHECK(cloud.splats[1] ==
        Splat{.center = {1, 0, 0}, .sigma = glm::vec3(0.1f), .rotation = {0, 0, 1, 0}, .opacity = 0.9f});
  CHECK(cloud.harmonics == std::vector<glm::vec3>{{1, 0, 0}, {0, 1, 0}});
  const DrawList& list = part.list();
  CHECK(glm::dvec3(list.world_from_node[list.items[0].transform] * glm::dvec4(0, 1, 0, 0)) == glm::dvec3(0, 0, 1));
  SplatPart linear(splat_gltf("srgb_rec709_display", "lin_rec709_display"), "", "s.gltf");
  CHECK(linear.cloud().encoding == SplatEncoding::linear);
}

TEST_CASE("glTF: what is not known is points, and what breaks the extension is refused") {
  for (const auto& [from, to, what] :
       {std::array{"ellipse", "cube", "with another kernel than \"ellipse\" are taken as points"},
        std::array{"srgb_rec709_display", "aces", "with another colorSpace than"},
        std::array{"\"kernel\"", "\"projection\":\"fisheye\",\"kernel\"", "with another projection than"}}) {
    CAPTURE(std::string(to));
    SplatPart part(splat_gltf(from, to), "", "s.gltf");
    REQUIRE(part.warnings().size() == 1);
    CHECK(contains(part.warnings()[0], what));
    CHECK(part.list().meshes[0]->splats == nullptr);
    CHECK(part.list().meshes[0]->positions.size() == 2);
  }
  const auto refused = [](const std::string& from, const std::string& to) {
    return error_of([&] { SplatPart(splat_gltf(from, to), "", "s.gltf"); });
  };
  CHECK(contains(refused("KHR_gaussian_splatting:SCALE", "_SCALE"),
                 "has Gaussian splats without the attribute KHR_gaussian_splatting:SCALE"));
  CHECK(contains(refused("KHR_gaussian_splatting:SH_DEGREE_0_COEF_0", "KHR_gaussian_splatting:SH_DEGREE_1_COEF_2"),
                 "without the attribute KHR_gaussian_splatting:SH_DEGREE_0_COEF_0"));
  CHECK(contains(refused("{\"bufferView\":1,", "{"),
                 "without the data of KHR_gaussian_splatting:ROTATION; save the file without compression"));
  CHECK(contains(refused("\"mode\":0", "\"mode\":1"), "has Gaussian splats that are no points; expected mode 0"));
  // The first place as a scale has no extent.
  SplatPart two(splat_gltf("\"KHR_gaussian_splatting:SCALE\":2", "\"KHR_gaussian_splatting:SCALE\":0"), "", "s.gltf");
  CHECK(two.cloud().splats.size() == 1);
  REQUIRE(two.warnings().size() == 1);
  CHECK(contains(two.warnings()[0],
                 "1 Gaussian splats are left out, whose opacity, scale, rotation or colour is not allowed"));
}

TEST_SUITE_END();

}  // namespace simvis
