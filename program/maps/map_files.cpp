#include "program/maps/map_files.h"

#include <strings.h>

#include <array>

#include "engine/base/assert.h"
#include "program/maps/octomap_file.h"
#include "program/output/npy_file.h"
#include "program/output/yaml_text.h"
#include "program/output/zip_file.h"

namespace simvis {
namespace {

std::string encode_pgm(const SceneCells& map) {
  constexpr char kOccupied = 0;
  constexpr unsigned char kFree = 254, kUnknown = 205;
  std::string bytes = "P5\n" + std::to_string(map.size.x) + ' ' + std::to_string(map.size.y) + "\n255\n";
  bytes.reserve(bytes.size() + map.states.size());
  for (std::uint32_t row = map.size.y; row-- > 0;) {
    for (std::uint32_t column = 0; column < map.size.x; ++column) {
      const CellState state = map.at({column, row, 0});
      bytes +=
          state == CellState::occupied ? kOccupied : static_cast<char>(state == CellState::free ? kFree : kUnknown);
    }
  }
  return bytes;
}

std::string encode_map_yaml(const SceneCells& map, const std::string& picture) {
  return "image: " + yaml_quoted(picture) + "\nmode: trinary\nresolution: " + yaml_number(map.resolution_m) +
         "\norigin: [" + yaml_number(map.origin_m.x) + ", " + yaml_number(map.origin_m.y) +
         ", 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
}

std::string encode_voxels(const SceneCells& map) {
  std::vector<std::int8_t> cells;
  cells.reserve(map.states.size());
  for (std::uint32_t x = 0; x < map.size.x; ++x) {
    for (std::uint32_t y = 0; y < map.size.y; ++y) {
      for (std::uint32_t z = 0; z < map.size.z; ++z) cells.push_back(static_cast<std::int8_t>(map.at({x, y, z})));
    }
  }
  const std::array resolution = {map.resolution_m};
  const std::array origin = {map.origin_m.x, map.origin_m.y, map.origin_m.z};
  const std::array<std::size_t, 3> size = {map.size.x, map.size.y, map.size.z};
  return encode_zip(std::array<ZipEntry, 3>{
      {{"cells.npy", encode_npy(std::span<const std::int8_t>(cells), size)},
       {"resolution_m.npy", encode_npy(std::span<const double>(resolution), {})},
       {"origin_m.npy", encode_npy(std::span<const double>(origin), std::array<std::size_t, 1>{3})}}});
}

}  // namespace

std::optional<MapFormat> map_format_of(const std::filesystem::path& file) {
  const std::string ending = file.extension().string();
  const auto is = [&](const char* name) { return ::strcasecmp(ending.c_str(), name) == 0; };
  if (is(".yaml") || is(".yml")) return MapFormat::ros_map;
  if (is(".npz")) return MapFormat::voxels;
  if (is(".bt")) return MapFormat::octomap;
  return std::nullopt;
}

std::vector<std::filesystem::path> files_of_map(const std::filesystem::path& file, MapFormat format) {
  if (format != MapFormat::ros_map) return {file};
  std::filesystem::path picture = file;
  return {picture.replace_extension(".pgm"), file};
}

std::vector<MapFileBytes> encode_map(const SceneCells& map, const std::filesystem::path& file, MapFormat format) {
  const std::vector<std::filesystem::path> files = files_of_map(file, format);
  switch (format) {
    case MapFormat::ros_map:
      SIMVIS_ASSERT(map.size.z == 1);
      return {{files[0], encode_pgm(map)}, {files[1], encode_map_yaml(map, files[0].filename().string())}};
    case MapFormat::voxels:
      return {{files[0], encode_voxels(map)}};
    case MapFormat::octomap:
      return {{files[0], encode_octomap(map)}};
  }
  return {};
}

}  // namespace simvis
