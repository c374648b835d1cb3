// Scenes generated from geometry: written as OBJ into a temporary folder and loaded like a user's scene.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <numbers>
#include <sstream>

#include "bench/accuracy/scenes.h"

namespace simvis::bench {

namespace {

/// The text of a Wavefront OBJ file; z is up.
class ObjText {
 public:
  ObjText() { text_.precision(9); }

  void face(std::initializer_list<glm::dvec3> corners) {
    for (const glm::dvec3& c : corners) text_ << "v " << c.x << ' ' << c.y << ' ' << c.z << '\n';
    text_ << 'f';
    for (std::size_t i = 0; i < corners.size(); ++i) text_ << ' ' << ++corners_;
    text_ << '\n';
  }
  std::string str() const { return text_.str(); }

 private:
  std::ostringstream text_;
  std::size_t corners_ = 0;
};

std::optional<Simulation> load_obj(const std::string& name, const ObjText& text) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("simvis_accuracy_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / (name + ".obj")) << text.str();
  std::optional<Simulation> simulation = Simulation::from_string(
      "<part file=\"" + name + ".obj\" name=\"WORLD\" insert_at=\"ROOT\"/>", {}, folder, name + ".xml");
  std::filesystem::remove_all(folder);
  return simulation;
}

/// Adds an upright rectangle on the line from `from` to `to`, between the two heights.
void add_wall(ObjText& obj, glm::dvec2 from, glm::dvec2 to, double low_m, double high_m) {
  obj.face({{from, low_m}, {to, low_m}, {to, high_m}, {from, high_m}});
}

void add_level(ObjText& obj, glm::dvec2 low, glm::dvec2 high, double z_m) {
  obj.face({{low.x, low.y, z_m}, {high.x, low.y, z_m}, {high.x, high.y, z_m}, {low.x, high.y, z_m}});
}

}  // namespace

std::optional<Simulation> load_corridor() {
  constexpr double kHalfLength_m = 30, kHalfWidth_m = 1, kHeight_m = 2.5;
  constexpr double kNicheWidth_m = 1, kNicheHeight_m = 2.1, kNicheDepth_m = 0.25, kNicheEvery_m = 5;
  ObjText obj;
  add_level(obj, {-kHalfLength_m, -kHalfWidth_m}, {kHalfLength_m, kHalfWidth_m}, 0);
  add_level(obj, {-kHalfLength_m, -kHalfWidth_m}, {kHalfLength_m, kHalfWidth_m}, kHeight_m);
  for (const double x : {-kHalfLength_m, kHalfLength_m}) {
    add_wall(obj, {x, -kHalfWidth_m}, {x, kHalfWidth_m}, 0, kHeight_m);
  }
  for (const double side : {-1.0, 1.0}) {
    const double y = side * kHalfWidth_m, back = side * (kHalfWidth_m + kNicheDepth_m);
    add_wall(obj, {-kHalfLength_m, y}, {kHalfLength_m, y}, kNicheHeight_m, kHeight_m);
    double wall_from = -kHalfLength_m;
    // The doors of one side stand between those of the other side.
    const double first = -kHalfLength_m + (side < 0 ? 0.25 : 0.75) * kNicheEvery_m;
    for (double door = first; door < kHalfLength_m; door += kNicheEvery_m) {
      const double left = door - kNicheWidth_m / 2, right = door + kNicheWidth_m / 2;
      add_wall(obj, {wall_from, y}, {left, y}, 0, kNicheHeight_m);
      add_wall(obj, {left, y}, {left, back}, 0, kNicheHeight_m);
      add_wall(obj, {left, back}, {right, back}, 0, kNicheHeight_m);
      add_wall(obj, {right, back}, {right, y}, 0, kNicheHeight_m);
      for (const double z : {0.0, kNicheHeight_m}) {
        add_level(obj, {left, std::min(y, back)}, {right, std::max(y, back)}, z);
      }
      wall_from = right;
    }
    add_wall(obj, {wall_from, y}, {kHalfLength_m, y}, 0, kNicheHeight_m);
  }
  return load_obj("corridor", obj);
}

std::optional<Simulation> load_poles() {
  constexpr int kPoles = 200, kSides = 12;
  constexpr double kNearest_m = 2, kFarthest_m = 40, kThinnest_m = 0.002, kThickest_m = 0.2, kHeight_m = 3;
  constexpr double kFloor_m = 60;
  constexpr double kGolden = 0.6180339887498949;  // its multiples modulo 1 are evenly distributed
  ObjText obj;
  add_level(obj, {-kFloor_m, -kFloor_m}, {kFloor_m, kFloor_m}, 0);
  for (int i = 0; i < kPoles; ++i) {
    const double distance_m = kNearest_m * std::pow(kFarthest_m / kNearest_m, static_cast<double>(i) / (kPoles - 1));
    const double bearing = 2 * std::numbers::pi * std::fmod(i * kGolden, 1.0);
    // The radii have their own sequence, so that thin poles stand near and far.
    const double radius_m = kThinnest_m / 2 * std::pow(kThickest_m / kThinnest_m, std::fmod(i * std::sqrt(2.0), 1.0));
    const glm::dvec2 middle = distance_m * glm::dvec2(std::cos(bearing), std::sin(bearing));
    const auto corner = [&](int k) {
      const double angle = 2 * std::numbers::pi * k / kSides;
      return middle + radius_m * glm::dvec2(std::cos(angle), std::sin(angle));
    };
    for (int k = 0; k < kSides; ++k) add_wall(obj, corner(k), corner((k + 1) % kSides), 0, kHeight_m);
  }
  return load_obj("poles", obj);
}

}  // namespace simvis::bench
