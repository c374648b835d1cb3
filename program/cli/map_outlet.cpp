#include "program/cli/map_outlet.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <set>
#include <string>
#include <system_error>
#include <utility>

#include <simvis/diagnostics.h>
#include <simvis/location.h>
#include <simvis/pose.h>
#include "engine/base/assert.h"
#include "engine/base/file_writing.h"
#include "engine/base/output_target.h"
#include "engine/base/result_lock.h"
#include "engine/base/words.h"
#include "engine/draw/solid_cloud.h"
#include "program/cli/load_scene.h"
#include "program/maps/map_files.h"
#include "program/output/atomic_file.h"
#include "program/output/new_folders.h"
#include "simvis/built_scene.h"

namespace simvis {
namespace {

constexpr glm::dvec2 kMapHeights_m(0.1, 1);                        // above the floor, and as high as small robots
constexpr double kMinResolution_m = 1e-4, kMaxResolution_m = 1e6;  // part files have no larger cells

[[noreturn]] void refuse(const char* option, const std::string& text, const char* expected) {
  throw InputError(std::string(option) + ": " + in_quotes(text) + " is not allowed, expected " + expected);
}

// The numbers of an option, separated by commas. Each is a coordinate in metres.
std::vector<double> coordinates(const char* option, const std::string& text, std::size_t count, const char* expected) {
  std::vector<double> numbers;
  bool is_allowed = true;
  for (const std::string_view cell : cells_of(text)) {
    numbers.push_back(0);
    is_allowed = is_allowed && parse_number(cell, numbers.back()) && std::abs(numbers.back()) <= kMaxCoordinate_m;
  }
  if (!is_allowed || numbers.size() != count) refuse(option, text, expected);
  return numbers;
}

MapDesc map_desc(const Options& options, MapFormat format) {
  MapDesc desc{.resolution_m = options.export_resolution_m, .is_flat = format == MapFormat::ros_map};
  if (!(desc.resolution_m >= kMinResolution_m && desc.resolution_m <= kMaxResolution_m)) {
    throw InputError("--export-resolution: " + format_number(desc.resolution_m) + " is not allowed, expected from " +
                     format_number(kMinResolution_m) + " to " + format_number(kMaxResolution_m) + " m");
  }
  if (desc.is_flat) desc.heights_m = kMapHeights_m;
  if (!options.export_heights.empty()) {
    constexpr const char* kExpected = "LOW,HIGH in metres, the lower one first";
    const std::vector<double> heights = coordinates("--export-heights", options.export_heights, 2, kExpected);
    if (heights[0] >= heights[1]) refuse("--export-heights", options.export_heights, kExpected);
    desc.heights_m = {heights[0], heights[1]};
  }
  if (!options.export_area.empty()) {
    constexpr const char* kExpected = "X0,Y0,X1,Y1 in metres, the lower ones first";
    const std::vector<double> area = coordinates("--export-area", options.export_area, 4, kExpected);
    if (area[0] >= area[2] || area[1] >= area[3]) refuse("--export-area", options.export_area, kExpected);
    desc.area_m = {{area[0], area[1]}, {area[2], area[3]}};
  }
  if (!options.export_start.empty()) {
    const std::size_t count = desc.is_flat ? 2 : 3;
    const std::vector<double> start =
        coordinates("--export-start", options.export_start, count, desc.is_flat ? "X,Y in metres" : "X,Y,Z in metres");
    desc.start_m = {start[0], start[1], desc.is_flat ? 0 : start[2]};
  }
  return desc;
}

// Throws InputError if a file of the map has the name of a camera's calibration in the folder of results.
void require_free_names(const Options& options, MapFormat format, const Simulation& simulation) {
  if (!options.writes) return;
  // Empty below a link that leads to itself, where no file can be made.
  const auto resolved = [](const std::filesystem::path& path) {
    std::error_code error;
    std::filesystem::path canonical = std::filesystem::weakly_canonical(std::filesystem::absolute(path), error);
    return error ? std::filesystem::path() : canonical;
  };
  const std::filesystem::path folder = resolved(options.out);
  for (const std::filesystem::path& file : files_of_map(options.export_file, format)) {
    const std::filesystem::path named = resolved(file);
    for (const SensorInfo& sensor : simulation.sensors()) {
      for (const char* const view : {"", "_left", "_right"}) {
        if (named != folder / (sensor.name + view + ".yaml")) continue;
        throw InputError("--export: " + file.string() + " is reserved for the calibration of sensor " +
                         in_quotes(sensor.name) + ", expected another name");
      }
    }
  }
}

class MapOutlet : public RunOutlet {
 public:
  MapOutlet(const std::filesystem::path& file, MapFormat format, const MapDesc& desc, std::vector<std::string> ignored,
            Simulation& simulation)
      : simulation_(simulation),
        name_(file),
        format_(format),
        desc_(desc),
        ignored_(std::move(ignored)),
        folders_(file.has_parent_path() ? file.parent_path() : ".") {
    for (const std::filesystem::path& each : files_of_map(file, format)) {
      locks_.emplace_back(each);
      files_.emplace_back(each);
    }
    in_option("--export-ignore", [this] { ignored_parts(); });
  }

  void frame(const FrameTime& /*time*/) override { has_frames_ = true; }

  void finish() override {
    if (!has_frames_) return;
    in_option("--export", [this] { write(); });
  }

  bool shows_all_content() const override { return true; }

 private:
  void write() {
    const DrawList& list = simulation_.diagnostics().draw_list();
    const std::vector<bool> left_out = ignored_items();
    const SceneCells map = map_scene(list, left_out, desc_);
    warn_of_missing_cells(map, list, left_out);
    const std::vector<MapFileBytes> contents = encode_map(map, name_, format_);
    SIMVIS_ASSERT(contents.size() == files_.size());
    for (std::size_t i = 0; i < contents.size(); ++i) files_[i].write(contents[i].bytes);
    if (files_.size() > 1) remove_earlier_file();
    for (AtomicFile& each : files_) each.commit();
  }

  // The file that names the others: between two commits it would name those of another map.
  void remove_earlier_file() const {
    const OutputTarget target = output_target(name_);
    if (target.is_stream) return;
    std::error_code error;
    std::filesystem::remove(target.file, error);
    if (error) throw_file_error(name_, "cannot be replaced", error.value());
  }

  // The insertion points whose shapes are left out.
  std::set<std::string> ignored_parts() const {
    const ObjectTree& objects = built_scene(simulation_).scene.objects();
    std::set<std::string> parts;
    for (const std::string& name : ignored_) {
      std::vector<std::string> unknown;
      for (const std::uint32_t object : objects.named(name, unknown)) {
        for (const std::string& part : objects.names_in(object)) parts.insert(part);
      }
      if (!unknown.empty()) throw InputError(objects.unknown("part or link", unknown[0]));
    }
    return parts;
  }

  std::vector<bool> ignored_items() const {
    const std::set<std::string> parts = ignored_parts();
    std::vector<bool> ignored;
    for (const SceneItem& item : simulation_.items()) ignored.push_back(parts.contains(item.part));
    return ignored;
  }

  // Shapes that cameras see and the map lacks.
  void warn_of_missing_cells(const SceneCells& map, const DrawList& list, const std::vector<bool>& left_out) {
    const std::vector<SceneItem> items = simulation_.items();
    std::set<std::string> parts;
    for (std::size_t i = 0; i < items.size(); ++i) {
      const Mesh& mesh = *list.meshes[list.items[i].mesh];
      const bool is_cloud = mesh.topology == Topology::points && !mesh.indices.empty() && !is_solid_cloud(mesh);
      if (list.items[i].visible && !left_out[i] && (is_cloud || mesh.splats)) parts.insert(items[i].part);
    }
    if (!parts.empty()) {
      const std::string more = parts.size() > 1 ? " and " + std::to_string(parts.size() - 1) + " more" : "";
      simulation_.warn(name_.string() + ": the map lacks part " + in_quotes(*parts.begin()) + more +
                       ": points without a radius and Gaussian splats have no surface");
    }
    if (std::ranges::find(map.states, CellState::occupied) != map.states.end()) return;
    simulation_.warn(name_.string() + ": the map has no occupied cell, expected surfaces between its heights");
  }

  Simulation& simulation_;
  std::filesystem::path name_;
  MapFormat format_;
  MapDesc desc_;
  std::vector<std::string> ignored_;
  NewFolders folders_;  // removed behind the files in them
  std::deque<ResultLock> locks_;
  std::deque<AtomicFile> files_;
  bool has_frames_ = false;
};

}  // namespace

std::unique_ptr<RunOutlet> map_outlet(const Options& options, Simulation& simulation) {
  const std::optional<MapFormat> format = map_format_of(options.export_file);
  SIMVIS_ASSERT(format);
  const MapDesc desc = map_desc(options, *format);
  require_free_names(options, *format, simulation);
  return std::make_unique<MapOutlet>(options.export_file, *format, desc, options.export_ignore, simulation);
}

void require_map_for_map_options(const Options& options) {
  const bool is_given = options.names_export_resolution || !options.export_heights.empty() ||
                        !options.export_area.empty() || !options.export_start.empty() || !options.export_ignore.empty();
  if (!is_given || map_format_of(options.export_file)) return;
  throw InputError("--export: " + in_quotes(options.export_file) +
                   " is no map, which the other options of --export describe, expected a name that ends with .yaml, "
                   ".npz or .bt");
}

}  // namespace simvis
