// Scenes as plain structs: shapes, materials, motions, lenses, sensors, outputs
// and neighbours. The same struct is written as XML, for SimVis, and placed by
// exact_world.h, for the test.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "tests/support/splat_file.h"

namespace simvis::combined {

/// As the attribute pose_offset: metres, then degrees.
struct Place {
  std::array<double, 6> number{};
  bool operator==(const Place&) const = default;
};

enum class ShapeKind : std::uint8_t {
  box,
  sphere,
  cylinder,
  cone,
  capsule,
  plane,
  triangles,
  heights,
  balls,  ///< points of a cloud
  discs,  ///< the same
  splats  ///< seen by cameras and beams
};
inline constexpr std::size_t kShapeKinds = 11;

using Triangle = std::array<glm::dvec3, 3>;

/// A picture of heights: codes of 16 bits, row by row from the top.
struct Heights {
  int columns = 2, rows = 2;
  double low_m = 0, high_m = 1;  ///< of the codes 0 and 65535
  std::vector<std::uint16_t> codes{};
};

inline constexpr int kManyHeights = 514;  ///< rows and columns of a picture that is no mesh: see kMinGridCells

/// A point of a cloud: the place, in floats, and the normal of a disc, of any length.
struct CloudPoint {
  glm::dvec3 at_m{0}, normal{0, 0, 1};
};

inline constexpr int kFrames = 2;  ///< each scene is measured at 0 s and at kFrame_s
inline constexpr double kRate_hz = 10;
inline constexpr int kNoParent = -1;  ///< the part FRAME, in which everything stands

/// A frame B<i> that may move, and in it the shape S<i>, which may be scaled.
struct Body {
  int parent = kNoParent;  ///< in CombinedScene::bodies, before this one
  Place offset{};
  bool moves = false;
  std::array<Place, kFrames> move{};  ///< of an element `pose`, by frame
  bool has_joint = false, slides = false;
  glm::dvec3 axis{0, 0, 1};
  std::array<double, kFrames> joint{};  ///< degrees, or metres, by frame
  ShapeKind kind = ShapeKind::box;
  glm::dvec3 size_m{1};
  double radius_m = 1, length_m = 1;
  std::vector<Triangle> triangles{};  ///< coordinates are floats
  Heights heights{};                  ///< over size_m along x and y
  std::vector<CloudPoint> points{};   ///< of radius_m
  std::vector<test::FileSplat> splats{};
  bool single_sided = false;  ///< cameras see no backs of these triangles
  glm::dvec3 scale{1};
  double opacity = 1;
  bool has_class = false;
};

/// Of `other` sensors nothing is compared with geometry: what a scene is
/// compared with changes none of their bytes.
enum class SensorKind : std::uint8_t { scanner, camera, stereo_camera, range, keypoints, imu, odometry, other };

/// A sensor C<i>. Angles are degrees.
struct SensorDesc {
  SensorKind kind = SensorKind::scanner;
  int parent = kNoParent;  ///< the frame of this body
  Place offset{};
  // Scanners.
  int beams = 61, rings = 3;
  double half_width_deg = 40, half_height_deg = 20;
  std::string method = "raycast";  ///< raycast, hybrid, planar or nearest
  double sweep_s = 0;
  bool truth = false;
  double range_min_m = 0.05, range_max_m = 80;  ///< of single beams, too
  // Cameras.
  int width_px = 32, height_px = 24;
  double hfov_deg = 60, near_m = 0.05;
  std::string outputs = "depth";
  std::string lens = "none";       ///< as the attribute distortion
  std::array<double, 5> lens_k{};  ///< k1 k2 k3, then p1 p2 or k4
  double row_time_s = 0;
  double baseline_m = 0.12;
  std::string layer = "visible";
  double radius_m = 0.01;  ///< of the points of keypoints, which are the frames of all bodies
  std::string other{};     ///< attributes of another sensor, with its type
};

/// Returns whether a word is in a list of words, such as `outputs`.
bool has_word(const std::string& words, const std::string& word);

/// What a scene is compared with, besides the oracle.
enum class Relation : std::uint8_t { moved, doubled, mirrored, split, shuffled, company, own_rates };
inline constexpr int kRelations = 7;

struct CombinedScene {
  std::uint64_t seed = 0;
  Place frame{};  ///< of the part FRAME
  std::vector<Body> bodies{};
  std::vector<SensorDesc> sensors{};
  Relation relation = Relation::shuffled;
};

/// The order in which commands stand in the file, and what stands beside the
/// scene.
struct Writing {
  std::uint64_t order = 0;     ///< 0: as in the struct; else another one, in which
                               ///< parents come before children
  bool more_sensors = false;   ///< of types whose measurements nobody compares
  bool more_outputs = false;   ///< of cameras: those that come from the same drawing or rays
  double sensors_rate_hz = 0;  ///< of the scene's own sensors; 0: every frame
};

/// Writes scene.xml, the files of its meshes and, if something moves,
/// trajectory.csv into a folder.
void write_scene(const CombinedScene& scene, const std::filesystem::path& folder, const Writing& writing = {});

/// What a parameter is in the frame.
struct Setting {
  std::string element, parameter;
  double value = 0;
};
std::vector<Setting> settings_of(const CombinedScene& scene, std::size_t frame);

/// Returns whether a body has kManyHeights. An event camera looks at each moving edge that comes into a pixel, and such
/// a body has hundreds of thousands of edges.
bool has_many_heights(const CombinedScene& scene);

/// The scene after its relation: everything moved, twice as large, mirrored, or
/// with each triangle in two. Other relations change nothing here.
CombinedScene related(const CombinedScene& scene);

/// Scenes that are simpler by one step each, the simplest first.
std::vector<CombinedScene> simpler(const CombinedScene& scene);

}  // namespace simvis::combined
