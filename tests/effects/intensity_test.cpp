// Returned laser power from matte walls (near and far, perpendicular and slanted, dark and bright, textured) and from
// retro-reflectors.
#include <algorithm>
#include <limits>
#include <sstream>

#include <simvis/simulation.h>
#include "sensors/measured_table.h"
#include "tests/support/element_scene.h"
#include "tests/support/reference_directions.h"

TEST_SUITE_BEGIN("effects");

namespace simvis::test {
namespace {

// Base colours are float32, and so is their product with vertex colours and textures: a few roundings of 2^-24.
// Everything else is double: ranges, and normals of corners that float32 represents exactly.
constexpr double kRounding = 4 * 0x1p-24;

void check_intensity(double seen, double expected) {
  CAPTURE(seen);
  CAPTURE(expected);
  CHECK(std::abs(seen - expected) <= kRounding * expected);
}

// Beams at -60, -50, ..., 60 degrees.
constexpr int kBeams = 13;
double azimuth(int beam) { return (10 * beam - 60) * kPi / 180; }
const std::string kScanner =
    R"(<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="13" min_angle="-60" max_angle="60" )";
const std::string kPart = R"(<part file="wall.gltf" name="WALL" insert_at="ROOT" up="z"/>)";

std::string material(const std::string& attributes, const std::string& name = "M") {
  return "<element type='material' name='" + name + "' insert_at='ROOT' part='WALL' " + attributes + "/>";
}

// A wall perpendicular to x.
GltfBuilder wall(const glm::vec4& color, float x = 4) {
  GltfBuilder file;
  add_plate(file, {.x = x, .left = 50, .right = -50}, file.append("materials", painted("Paint", color)));
  return file;
}

std::vector<double> intensities(const GltfBuilder& file, const std::string& commands) {
  World world({{"wall.gltf", file}}, kPart + commands);
  world->step();
  const SharedNumbers<double> channel = world->scan("SCAN").channel("intensity");
  REQUIRE(channel.size() == world->scan("SCAN").range_m.size());
  return channel;
}

}  // namespace

TEST_CASE("a matte wall returns reflectance x cosine / range^2") {
  struct Case {
    glm::vec4 color;
    float x;
  };
  for (const Case& c : {Case{{1, 1, 1, 1}, 1}, Case{{1, 1, 1, 1}, 4}, Case{{0.5f, 0.25f, 0, 1}, 4},
                        Case{{0.125f, 0.125f, 0.125f, 1}, 16}}) {
    CAPTURE(c.x);
    const std::vector<double> seen = intensities(wall(c.color, c.x), kScanner + R"(intensity="on"/>)");
    const double reflectance = (c.color.r + c.color.g + c.color.b) / 3.0;
    for (int beam = 0; beam < kBeams; ++beam) {
      const double cosine = std::cos(azimuth(beam)), range_m = c.x / cosine;
      check_intensity(seen[beam], reflectance * cosine / (range_m * range_m));
    }
  }
}

TEST_CASE(
    "a material says what lasers see of it; of several that do the last counts; no surface gives back more than all") {
  const GltfBuilder blue = wall({0, 0, 1, 1});
  const auto ahead = [&](const std::string& commands) {
    return intensities(blue, commands + kScanner + R"(intensity="on"/>)")[kBeams / 2];
  };
  check_intensity(ahead(""), 1 / 3.0 / 16);
  check_intensity(ahead(material("reflectance='0.75'")), 0.75 / 16);
  check_intensity(ahead(material("reflectance='0.75'", "A") + material("reflectance='0.25'", "B")), 0.25 / 16);
  check_intensity(ahead(material("reflectance='0.75'", "A") + material("red='0'", "B")), 0.75 / 16);
  check_intensity(ahead(material("blue='0.5'")), 0.5 / 3 / 16);
  check_intensity(ahead(material("blue='100'")), 1 / 16.0);
  CHECK(ahead(material("reflectance='0'")) == 0);
}

TEST_CASE("the laser properties of a material are content of the draw list: they are compared, hashed and printed") {
  const auto list_of = [](std::optional<float> reflectance, float retro_reflectance) {
    Material material;
    material.reflectance = reflectance;
    material.retro_reflectance = retro_reflectance;
    DrawList list;
    list.materials.push_back(std::make_shared<Material>(material));
    list.material_revision.push_back(0);
    return list;
  };
  const DrawList plain = list_of({}, 0);
  for (const DrawList& other : {list_of(0.0f, 0), list_of(0.5f, 0), list_of({}, 0.5f)}) {
    CHECK_FALSE(same_content(plain, other));
    CHECK(content_hash(plain) != content_hash(other));
  }
  CHECK(content_hash(list_of(0.5f, 0)) != content_hash(list_of({}, 0.5f)));
  std::ostringstream page;
  page << list_of(0.5f, 200);
  CHECK(contains(page.str(), ", reflectance 0.5, retro-reflectance 200"));
}

TEST_CASE("the intensity shows a texture in linear light") {
  GltfBuilder file;
  // From the left: sRGB codes 188 and 64. Nearest texels are used, so every beam hits one of them.
  const int image = file.append(
      "images", {{"uri", "data:image/png;base64," + base64(png(2, 1, 8, 2, {{188, 188, 188, 64, 64, 64}}))}});
  const int sampler = file.append("samplers", {{"magFilter", 9728}, {"minFilter", 9728}});
  json print = painted("Print", {1, 1, 1, 1});
  print["pbrMetallicRoughness"]["baseColorTexture"]["index"] =
      file.append("textures", {{"source", image}, {"sampler", sampler}});
  add_plate(file, {.left = 50, .right = -50}, file.append("materials", print));
  const std::vector<double> seen = intensities(file, kScanner + R"(intensity="on"/>)");
  const auto linear = [](double code) { return std::pow((code / 255 + 0.055) / 1.055, 2.4); };
  for (int beam = 0; beam < kBeams; ++beam) {
    if (beam == kBeams / 2) continue;  // on the edge between them
    const double cosine = std::cos(azimuth(beam)), range_m = 4 / cosine;
    check_intensity(seen[beam], linear(beam < kBeams / 2 ? 64 : 188) * cosine / (range_m * range_m));
  }
}

TEST_CASE("a retro-reflector returns light at all angles up to its entrance angle") {
  const std::string every_degree =
      R"(<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="121" min_angle="-60" max_angle="60" )"
      R"(intensity="on"/>)";
  const std::vector<double> seen =
      intensities(wall({1, 1, 1, 1}), material("reflectance='0.5' retro_reflectance='200'") + every_degree);
  for (int beam = 0; beam < 121; ++beam) {
    CAPTURE(beam);
    const int slant_deg = std::abs(beam - 60);
    if (slant_deg == 40) continue;  // on the limit
    const double cosine = std::cos(slant_deg * kPi / 180), range_m = 4 / cosine;
    const bool within = slant_deg < 40;
    check_intensity(seen[beam], (within ? 200 : 0.5 * cosine) / (range_m * range_m));
  }
}

namespace {

// All outputs of a scene and their cost.
struct Result {
  Scan scan;
  FrameCounters counters;
  std::vector<std::string> effects;
};

Result result_of(const std::string& commands) {
  World world({{"wall.gltf", wall({1, 1, 1, 1})}}, kPart + commands);
  world->step();
  Result result{world->scan("SCAN"), world->diagnostics().counters(), {}};
  for (const PlannedEffect& each : world->diagnostics().frame_plan().effects) result.effects.push_back(each.effect);
  return result;
}

}  // namespace

TEST_CASE("a retro-reflector that no scan can show costs nothing and changes nothing") {
  const std::string retro = material("retro_reflectance='200'");
  for (const char* method : {"planar", "raycast"}) {
    const std::string scanner = kScanner + "method='" + method + "'/>";
    const Result plain = result_of(material("") + scanner), with = result_of(retro + scanner);
    CHECK(with.scan.range_m == plain.scan.range_m);
    CHECK(with.scan.error_bound_m == plain.scan.error_bound_m);
    CHECK(with.scan.channels().empty());
    CHECK(with.effects.empty());
    CHECK(with.counters == plain.counters);
  }
  CHECK(result_of(retro + kScanner + "intensity='on'/>").effects ==
        std::vector<std::string>{"retro_reflection", "intensity"});
  CHECK(result_of(material("") + kScanner + "intensity='on'/>").effects == std::vector<std::string>{"intensity"});
}

TEST_CASE("intensity that is off equals intensity that is not named; with intensity on, ranges are those of raycast") {
  const Result plain = result_of(kScanner + "/>"), off = result_of(kScanner + "intensity='off'/>");
  CHECK(off.scan.range_m == plain.scan.range_m);
  CHECK(off.scan.error_bound_m == plain.scan.error_bound_m);
  CHECK(off.scan.channels().empty());
  CHECK(off.counters == plain.counters);
  const Result cast = result_of(kScanner + "method='raycast'/>"), on = result_of(kScanner + "intensity='on'/>");
  CHECK(on.scan.range_m == cast.scan.range_m);
  CHECK(on.scan.error_bound_m == cast.scan.error_bound_m);
  CHECK(contains(error_of([] { result_of(kScanner + "method='planar' intensity='on'/>"); }),
                 "cannot show \"intensity\""));
}

TEST_CASE("there is no intensity where there is no range; it is the last column of the table") {
  // The wall at 4 m reaches from the left edge to -1 m, so beams to its right miss it. Beams below range_min are
  // blocked, and others are lost by chance.
  GltfBuilder file;
  add_plate(file, {.left = 50, .right = -1}, file.append("materials", painted("Paint", {1, 1, 1, 1})));
  World world({{"wall.gltf", file}}, kPart + kScanner + R"(intensity="on" dropout="0.3" range_min="4.1"/>)");
  world->step();
  const Scan& scan = world->scan("SCAN");
  const SharedNumbers<double> seen = scan.channel("intensity");
  int lost = 0;
  for (int beam = 0; beam < kBeams; ++beam) {
    const double range_m = scan.range_m[beam], expected_m = 4 / std::cos(azimuth(beam));
    const bool hits = 4 * std::tan(azimuth(beam)) > -1;
    if (!hits) CHECK(std::isinf(range_m));
    if (hits && expected_m < 4.1) CHECK(range_m == 0);
    lost += hits && std::isinf(range_m);
    CHECK(std::isnan(seen[beam]) == (range_m == 0 || std::isinf(range_m)));
  }
  CHECK(lost > 0);
  const MeasuredTable table = measured_table(world->measurement("SCAN"));
  REQUIRE(table.columns.back().name == "intensity");
  for (int beam = 0; beam < kBeams; ++beam) {
    const double cell = table.values[(static_cast<std::size_t>(beam) + 1) * table.columns.size() - 1];
    CHECK((std::isnan(seen[beam]) ? std::isnan(cell) : cell == seen[beam]));
  }
}

}  // namespace simvis::test

TEST_SUITE_END();
