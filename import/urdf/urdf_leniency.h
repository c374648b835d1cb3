// Mends what is usual in URDF files but stops liburdfdom, as programs of robots read it.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scenegraph/language/xml_text.h"

namespace simvis {

struct UrdfMending {
  std::vector<std::string> warnings;
  std::set<std::string> joints_without_limits;  ///< revolute and prismatic joints to be left open
  /// Visuals that are capsules, by link and by their number in it. They stand as cylinders in the document, because
  /// liburdfdom knows no capsules.
  std::set<std::pair<std::string, std::size_t>> capsules;
};

/// The text of a list of numbers with a space in place of each comma, as programs write and read it that take "1, 2,
/// 3".
std::string without_commas(std::string_view numbers);

/// Changes the document in place:
///   silently removed, because SimVis does not read it  <inertial>, <collision>, <dynamics>, <safety_controller>,
///                                                      <calibration>
///   silently completed, because SimVis does not read it  effort and velocity of a <limit>
///   silently kept                                        capsules, as pybullet and Drake read them
///   with a warning
///     commas between the numbers of vectors: spaces
///     visuals without a geometry that SimVis knows, and boxes, cylinders, spheres and meshes of size 0: left out
///     <mimic> of a fixed joint, or of a leader that does not exist: ignored
///     a lower limit above the upper limit, and no limits at all: the joint is opened
///     a material that is defined twice: the first definition counts
///     a material that is defined nowhere: grey
///     a robot without a name: "robot"
UrdfMending mend_urdf(const XmlText& text);

}  // namespace simvis
