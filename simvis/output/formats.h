// The file formats that a run writes, as `--format` chooses them.
#pragma once

#include <set>
#include <span>
#include <string>

namespace simvis {

/// The formats of each kind of data. Each kind has at least one.
struct OutputFormats {
  std::set<std::string> color{"png"};  ///< png, jpeg, exr
  std::set<std::string> depth{"exr"};  ///< exr, png, npy
  std::set<std::string> scan{"csv"};   ///< csv, npy, npz, ply, pcd, bin
  /// Whether the EXR of a camera with depth also holds its colour: if no format of colour was chosen.
  bool color_beside_depth = true;
  double depth_unit_m = 0.001;  ///< the length of one code of a depth PNG

  bool operator==(const OutputFormats&) const = default;
};

/// Reads the values of `--format`: "[KIND=]NAME[,NAME...]", where KIND is color, depth or scan. A name without a kind
/// counts for every kind that has it. Kinds that no value names keep their defaults.
/// Throws InputError naming the value and what is allowed.
OutputFormats parse_formats(std::span<const std::string> values);

}  // namespace simvis
