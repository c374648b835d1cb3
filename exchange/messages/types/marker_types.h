// Messages of visualization_msgs.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "exchange/messages/field.h"
#include "exchange/messages/types/geometry_types.h"
#include "exchange/messages/types/sensor_types.h"
#include "exchange/messages/types/std_types.h"
#include "exchange/messages/types/trajectory_types.h"

namespace simvis::ros {

struct ColorRGBA {
  SIMVIS_MESSAGE("std_msgs/msg/ColorRGBA", r, g, b, a);
  float r = 0;
  float g = 0;
  float b = 0;
  float a = 0;
};

struct UVCoordinate {
  SIMVIS_MESSAGE("visualization_msgs/msg/UVCoordinate", u, v);
  float u = 0;
  float v = 0;
};

struct MeshFile {
  SIMVIS_MESSAGE("visualization_msgs/msg/MeshFile", filename, data);
  std::string filename;
  std::vector<std::uint8_t> data;
};

struct Marker {
  SIMVIS_MESSAGE("visualization_msgs/msg/Marker", header, ns, id, type, action, pose, scale, color, lifetime,
                 frame_locked, points, colors, texture_resource, texture, uv_coordinates, text, mesh_resource,
                 mesh_file, mesh_use_embedded_materials);
  static constexpr std::string_view kConstants =
      "int32 ARROW=0\n"
      "int32 CUBE=1\n"
      "int32 SPHERE=2\n"
      "int32 CYLINDER=3\n"
      "int32 LINE_STRIP=4\n"
      "int32 LINE_LIST=5\n"
      "int32 CUBE_LIST=6\n"
      "int32 SPHERE_LIST=7\n"
      "int32 POINTS=8\n"
      "int32 TEXT_VIEW_FACING=9\n"
      "int32 MESH_RESOURCE=10\n"
      "int32 TRIANGLE_LIST=11\n"
      "int32 ARROW_STRIP=12\n"
      "int32 ADD=0\n"
      "int32 MODIFY=0\n"
      "int32 DELETE=2\n"
      "int32 DELETEALL=3\n";
  static constexpr std::int32_t kCube = 1, kAdd = 0, kDeleteAll = 3;
  Header header;
  std::string ns;  ///< with `id`, what a later marker replaces
  std::int32_t id = 0;
  std::int32_t type = 0;
  std::int32_t action = 0;
  Pose pose;      ///< of the middle of a cube
  Vector3 scale;  ///< of a cube: the lengths of its edges
  ColorRGBA color;
  Duration lifetime;  ///< 0: until it is replaced
  bool frame_locked = false;
  std::vector<Point> points;
  std::vector<ColorRGBA> colors;
  std::string texture_resource;
  CompressedImage texture;
  std::vector<UVCoordinate> uv_coordinates;
  std::string text;
  std::string mesh_resource;
  MeshFile mesh_file;
  bool mesh_use_embedded_materials = false;
};

struct MarkerArray {
  SIMVIS_MESSAGE("visualization_msgs/msg/MarkerArray", markers);
  std::vector<Marker> markers;
};

}  // namespace simvis::ros
