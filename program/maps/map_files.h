// Maps of a scene as files: what --export writes for names that end with .yaml, .npz and .bt.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "program/maps/scene_cells.h"

namespace simvis {

/// One file of a map.
struct MapFileBytes {
  std::filesystem::path file;
  std::string bytes;
};

/// What a file format of maps holds.
enum class MapFormat : std::uint8_t {
  ros_map,  ///< a YAML file and a picture, as map_server of ROS reads them
  voxels,   ///< an archive of NumPy
  octomap   ///< a binary tree of OctoMap
};

/// By the ending of the name, in any case; empty: a map has no such file.
std::optional<MapFormat> map_format_of(const std::filesystem::path& file);

/// The names of the files of a map, the last of which names the others: of a ROS map the picture, and then `file`.
std::vector<std::filesystem::path> files_of_map(const std::filesystem::path& file, MapFormat format);

/// The files of a map, in the order of files_of_map():
///
///   ros_map  FILE.pgm, rows from the top: 0 occupied, 254 free, 205 unknown; FILE.yaml in mode trinary, with the
///            thresholds of map_saver of ROS 1, by which 205 is unknown for every map_server. The map has one layer
///            (asserted).
///   voxels   FILE.npz: cells, int8 [x, y, z] with 1 occupied, 0 free, -1 unknown; resolution_m; origin_m
///   octomap  FILE.bt, see octomap_file.h
///
/// Throws InputError of encode_octomap().
std::vector<MapFileBytes> encode_map(const SceneCells& map, const std::filesystem::path& file, MapFormat format);

}  // namespace simvis
