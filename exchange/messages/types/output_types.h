// Messages of SimVis's own for outputs of sensors that no standard message has.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "exchange/messages/field.h"
#include "exchange/messages/types/std_types.h"

namespace simvis::ros {

/// An output of a sensor, as docs/reference.md describes it.
struct Output {
  SIMVIS_MESSAGE("simvis_msgs/msg/Output", name, kind, unit, rows, columns, channels, type, data);
  std::string name;
  std::string kind;                ///< "image", "scan column", "table column", "scalar"
  std::string unit;                ///< empty: none
  std::uint32_t rows = 0;          ///< of an image, rings of a scan, rows of a table
  std::uint32_t columns = 0;       ///< of an image, beams in a ring
  std::uint32_t channels = 0;      ///< per pixel
  std::string type;                ///< of the numbers: "u8", "u32", "i32", "f32", "f64"
  std::vector<std::uint8_t> data;  ///< the numbers row by row, little-endian
};

struct OutputStamped {
  SIMVIS_MESSAGE("simvis_msgs/msg/OutputStamped", header, output);
  Header header;
  Output output;
};

}  // namespace simvis::ros
