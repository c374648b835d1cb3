// Messages of SimVis's own for outputs of sensors that no standard message has.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "exchange/messages/field.h"
#include "exchange/messages/types/std_types.h"

namespace simvis::ros {

/// An output of a sensor, as docs/reference.md describes it.
struct Output {
  static constexpr std::string_view kName = "simvis_msgs/msg/Output";
  std::string name;
  std::string kind;                ///< "image", "scan column", "table column", "scalar"
  std::string unit;                ///< empty: none
  std::uint32_t rows = 0;          ///< of an image, rings of a scan, rows of a table
  std::uint32_t columns = 0;       ///< of an image, beams in a ring
  std::uint32_t channels = 0;      ///< per pixel
  std::string type;                ///< of the numbers: "u8", "u32", "i32", "f32", "f64"
  std::vector<std::uint8_t> data;  ///< the numbers row by row, little-endian
  static constexpr auto field_table() {
    return std::tuple{Field{"name", &Output::name},       Field{"kind", &Output::kind},
                      Field{"unit", &Output::unit},       Field{"rows", &Output::rows},
                      Field{"columns", &Output::columns}, Field{"channels", &Output::channels},
                      Field{"type", &Output::type},       Field{"data", &Output::data}};
  }
};

struct OutputStamped {
  static constexpr std::string_view kName = "simvis_msgs/msg/OutputStamped";
  Header header;
  Output output;
  static constexpr auto field_table() {
    return std::tuple{Field{"header", &OutputStamped::header}, Field{"output", &OutputStamped::output}};
  }
};

}  // namespace simvis::ros
