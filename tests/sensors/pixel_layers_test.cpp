// The surfaces behind one another that a pixel sees, and which of them depth and labels mean.
#include "sensors/camera/pixel_layers.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include <simvis/diagnostics.h>
#include <simvis/simulation.h>
#include "tests/support/error_of.h"
#include "tests/support/parts/gltf_fixture.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

// A range of double that is stored as float32, and a depth that was multiplied by another one.
constexpr double kLayerStored = 0x1p-23;

constexpr double kThick_m = 0.02;
constexpr int kLayerWidth = 48, kLayerHeight = 36;

// Squares before the camera, one behind the other.
struct Square {
  const char* part;
  double ahead_m, half_m, covered;
};
constexpr Square kSquares[] = {{"THIN", 1, 0.15, 0.25}, {"THICK", 2, 0.6, 0.75}, {"WALL", 3, 1.4, 1}};

std::string squares() {
  std::string commands;
  for (const Square& square : kSquares) {
    const std::string side = std::to_string(2 * square.half_m), name = square.part;
    commands += "<part name='" + name + "' insert_at='ROOT' shape='box' size='0.02 " + side + " " + side +
                "' pose_offset='" + std::to_string(square.ahead_m + 0.01) + " 0 0 0 0 0'/>";
    if (square.covered == 1) continue;
    commands += "<element type='material' name='OF_" + name + "' insert_at='ROOT' part='" + name + "' opacity='" +
                std::to_string(square.covered) + "'/>";
  }
  return commands;
}

Simulation squares_seen_by(const std::string& attributes, const char* type = "camera") {
  Simulation simulation =
      Simulation::from_string("<simvis>" + squares() + "<sensor type='" + type +
                              "' name='CAM' insert_at='ROOT' width='" + std::to_string(kLayerWidth) + "' height='" +
                              std::to_string(kLayerHeight) + "' hfov='60' " + attributes + "/></simvis>");
  simulation.step();
  return simulation;
}

std::vector<double> layer_numbers(const Simulation& simulation, const std::string& name) {
  const Measurement measurement = simulation.measurement("CAM");
  const MeasuredArray* const array = measurement.find(name);
  REQUIRE_MESSAGE(array != nullptr, name);
  std::vector<double> all;
  for (std::size_t i = 0; i < array->count(); ++i) all.push_back(array->number(i));
  return all;
}

std::map<std::string, std::uint32_t> ids_of(const Simulation& simulation) {
  std::map<std::string, std::uint32_t> ids;
  for (const SceneItem& item : simulation.items()) ids[item.part] = item.instance;
  return ids;
}

// A side of a square: boxes show both of theirs.
struct Side {
  const Square* square;
  double ahead_m;
};

// The sides that a pixel's ray meets, the nearest first, and the ray's length for each metre ahead.
struct Met {
  std::vector<Side> sides;
  double per_depth = 1;
  bool leaves_by_edge = false;  // of a square: it meets the narrow side of the box
};

Met met_by(int pixel) {
  const double f_px = kLayerWidth / 2.0 / std::tan(30 * std::numbers::pi / 180);
  const double x = (pixel % kLayerWidth + 0.5 - kLayerWidth / 2.0) / f_px,
               y = (pixel / kLayerWidth + 0.5 - kLayerHeight / 2.0) / f_px;
  Met met{.sides = {}, .per_depth = std::sqrt(1 + x * x + y * y)};
  for (const Square& square : kSquares) {
    const auto meets = [&](double ahead_m) { return std::max(std::abs(x), std::abs(y)) * ahead_m < square.half_m; };
    if (!meets(square.ahead_m)) continue;
    met.sides.push_back({&square, square.ahead_m});
    if (square.covered == 1) break;
    met.sides.push_back({&square, square.ahead_m + kThick_m});
    met.leaves_by_edge |= !meets(square.ahead_m + kThick_m);
  }
  return met;
}

TEST_CASE("a pixel has all surfaces up to one that nothing shines through, with the light that they let pass") {
  for (const char* const type : {"camera", "stereo_camera"}) {
    for (const int most : {3, 6}) {
      const Simulation simulation =
          squares_seen_by("outputs='color layers' max_layers='" + std::to_string(most) + "'", type);
      const std::string prefix = std::string(type) == "camera" ? "" : "left_";
      const std::vector<double> range = layer_numbers(simulation, prefix + "layer_range"),
                                instance = layer_numbers(simulation, prefix + "layer_instance"),
                                passed = layer_numbers(simulation, prefix + "layer_transmission");
      std::map<std::string, std::uint32_t> ids = ids_of(simulation);
      REQUIRE(range.size() == static_cast<std::size_t>(kLayerWidth * kLayerHeight * most));
      std::map<std::size_t, int> pixels;
      for (int pixel = 0; pixel < kLayerWidth * kLayerHeight; ++pixel) {
        const Met met = met_by(pixel);
        if (met.leaves_by_edge) continue;
        ++pixels[met.sides.size()];
        double transmission = 1;
        for (std::size_t layer = 0; layer < static_cast<std::size_t>(most); ++layer) {
          const std::size_t i = static_cast<std::size_t>(pixel * most) + layer;
          if (layer >= met.sides.size()) {
            CHECK(std::isinf(range[i]));
            CHECK(instance[i] == 0);
            CHECK(passed[i] == 0);
            continue;
          }
          const Side& side = met.sides[layer];
          const double expected_m = side.ahead_m * met.per_depth;
          CHECK(std::abs(range[i] - expected_m) <= kLayerStored * expected_m);
          CHECK(instance[i] == ids.at(side.square->part));
          CHECK(std::abs(passed[i] - transmission) <= kLayerStored);
          transmission *= 1 - side.square->covered;
        }
      }
      for (const std::size_t count : {0, 1, 3, 5}) CHECK(pixels[count] > 10);
    }
  }
}

// Two-sided walls of real models are such faces. Their ranges differ by their roundings.
TEST_CASE("faces that coincide are one layer, whatever their first corner and winding") {
  const TemporaryFolder folder;
  const glm::vec3 corners[] = {{0.3f, -2.1f, -1.7f}, {-0.2f, 2.3f, -1.4f}, {0.1f, 0.2f, 1.9f}};
  std::vector<float> positions;
  for (const std::array<int, 3>& order : {std::array{0, 1, 2}, {1, 2, 0}, {0, 2, 1}, {2, 1, 0}}) {
    for (const int i : order) positions.insert(positions.end(), {corners[i].x, corners[i].y, corners[i].z});
  }
  test::GltfBuilder builder;
  builder.primitive({{"POSITION", builder.accessor<float>("VEC3", positions)}})["material"] = 0;
  builder.append("materials", {{"doubleSided", true}});
  write_text(folder / "faces.gltf", builder.text());
  Simulation simulation = Simulation::from_string(
      "<simvis><part name='FACES' insert_at='ROOT' file='faces.gltf' up='z' pose_offset='2.7 0.1 0.2 10 20 30'/>"
      "<element type='material' name='GLASS' insert_at='ROOT' part='FACES' opacity='0.75'/>"
      "<sensor type='camera' name='CAM' insert_at='ROOT' width='48' height='36' hfov='60' outputs='layers'/></simvis>",
      {}, folder.path());
  simulation.step();
  const std::vector<double> range = layer_numbers(simulation, "layer_range");
  int seen = 0;
  for (std::size_t i = 0; i < range.size(); i += 4) {
    seen += std::isfinite(range[i]);
    CHECK(std::isinf(range[i + 1]));
  }
  CHECK(seen > 200);
}

TEST_CASE("the layer decides depth, labels and all other truth together") {
  const auto index_of = [](const Met& met, const std::string& layer) {
    std::size_t i = 0;
    const double least = layer == "visible" ? 0.5 : layer == "first" ? 0.01 : 0.99;
    while (i < met.sides.size() && met.sides[i].square->covered < least) ++i;
    return i;
  };
  for (const std::string layer : {"visible", "first", "first_opaque"}) {
    CAPTURE(layer);
    for (const char* const type : {"camera", "stereo_camera"}) {
      Simulation simulation = squares_seen_by(
          "outputs='color depth instance range object_coordinates flow_backward' layer='" + layer + "'", type);
      const std::string prefix = std::string(type) == "camera" ? "" : "left_";
      const std::vector<double> depth = layer_numbers(simulation, prefix + "depth"),
                                range = layer_numbers(simulation, prefix + "range"),
                                instance = layer_numbers(simulation, prefix + "instance"),
                                place = layer_numbers(simulation, prefix + "object_coordinates");
      std::map<std::string, std::uint32_t> ids = ids_of(simulation);
      for (int pixel = 0; pixel < kLayerWidth * kLayerHeight; ++pixel) {
        const auto i = static_cast<std::size_t>(pixel);
        const Met met = met_by(pixel);
        const std::size_t seen = index_of(met, layer);
        if (seen == met.sides.size()) {
          CHECK(instance[i] == 0);
          CHECK(std::isinf(depth[i]));
          CHECK(std::isinf(range[i]));
          continue;
        }
        const Square& square = *met.sides[seen].square;
        // Drawn depths of planes before the camera round thrice more.
        CHECK(std::abs(depth[i] - square.ahead_m) <= 4 * kLayerStored * square.ahead_m);
        CHECK(std::abs(range[i] - square.ahead_m * met.per_depth) <= 4 * kLayerStored * range[i]);
        CHECK(instance[i] == ids.at(square.part));
        CHECK(std::abs(place[3 * i] + 0.01) <= 8 * kLayerStored * square.ahead_m);  // the side that faces the camera
      }
    }
  }
}

TEST_CASE("the layer changes no colour, and that of depth costs nothing where it is the usual one") {
  const auto work = [](const std::string& attributes) {
    const Simulation simulation = squares_seen_by(attributes);
    const Diagnostics diagnostics = simulation.diagnostics();
    return std::pair(diagnostics.counters(), diagnostics.ray_counters().rays);
  };
  CHECK(work("outputs='color depth'") == work("outputs='color depth' layer='visible' max_layers='9'"));
  CHECK(layer_numbers(squares_seen_by("outputs='color depth' layer='first'"), "color") ==
        layer_numbers(squares_seen_by("outputs='color depth'"), "color"));
}

TEST_CASE("a layer that a camera cannot give is an error at its place") {
  const auto error = [](const std::string& attributes) { return error_of([&] { squares_seen_by(attributes); }); };
  CHECK(contains(
      error("outputs='color' layer='first'"),
      ": error: attribute \"layer\": colour shows all layers, expected outputs with depth or truth beside it"));
  CHECK(contains(error("outputs='depth' layer='second'"), "first_opaque"));
  CHECK(contains(error("outputs='layers' max_layers='0'"), "max_layers"));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
