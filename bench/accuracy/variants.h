// The scanners and methods that are compared.
#pragma once

#include <string>
#include <vector>

namespace simvis::bench {

struct AccuracyScanner {
  std::string name;
  std::string attributes;  ///< attributes of a laser_scanner that define its beams
  std::vector<int> resolutions_px;
  bool lidar = false;
};

/// A planar scanner of 361 beams over a half circle; a lidar of 64 rings of 1024 beams all around.
std::vector<AccuracyScanner> accuracy_scanners();

/// One method with its parameters.
struct Variant {
  std::string sensor;         ///< its name in the scene
  std::string method;         ///< attribute method of laser_scanner
  std::string max_error_rel;  ///< empty if the method has none
  int resolution_px = 0;      ///< 0 if the method has none
};

/// All methods, at each tolerance and each resolution.
std::vector<Variant> variants_of(const AccuracyScanner& scanner);

/// Commands that put the variants into a scene, all on one mount: the element kMount, a pose.
std::string mount_xml(const AccuracyScanner& scanner, const std::vector<Variant>& variants);
inline constexpr const char* kMount = "ACCURACY_MOUNT";

}  // namespace simvis::bench
