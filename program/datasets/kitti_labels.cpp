#include "program/datasets/kitti_labels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <glm/gtc/constants.hpp>

namespace simvis {
namespace {

constexpr double kMinVisible = 0.8, kMinPartlyOccluded = 0.4;  // visible shares of a silhouette

int occlusion(double visible_fraction) {
  if (visible_fraction >= kMinVisible) return 0;
  return visible_fraction >= kMinPartlyOccluded ? 1 : 2;
}

/// An angle from -pi to pi.
double wrapped(double angle_rad) { return std::remainder(angle_rad, 2 * glm::pi<double>()); }

std::string type_of(std::uint32_t semantic, const std::map<std::uint32_t, std::string>& classes) {
  const auto found = classes.find(semantic);
  if (found == classes.end() || found->second.empty()) return "class_" + std::to_string(semantic);
  std::string type = found->second;
  std::ranges::replace(type, ' ', '_');
  return type;
}

std::string label(const ObjectInView& object, const std::string& type) {
  const glm::dvec3 heading = object.optical_from_box[0];  // the x axis of the box
  const glm::dvec3 bottom = object.centre_m - 0.5 * object.size_m.z * object.optical_from_box[2];
  const double rotation = std::atan2(-heading.z, heading.x);
  const double alpha = wrapped(rotation - std::atan2(bottom.x, bottom.z));
  std::array<char, 512> text{};
  std::snprintf(text.data(), text.size(), " %.2f %d %.4f %.2f %.2f %.2f %.2f %.4f %.4f %.4f %.4f %.4f %.4f %.4f\n",
                object.truncated, occlusion(object.visible_fraction), alpha, object.picture.x_min, object.picture.y_min,
                object.picture.x_max - 1, object.picture.y_max - 1, object.size_m.z, object.size_m.y, object.size_m.x,
                bottom.x, bottom.y, bottom.z, rotation);
  return type + text.data();
}

}  // namespace

std::string kitti_labels(const SeenView& view, const std::map<std::uint32_t, std::string>& classes) {
  std::string lines;
  for (const ObjectInView& object : view.objects) {
    if (object.visible_pixels > 0) lines += label(object, type_of(object.semantic, classes));
  }
  return lines;
}

}  // namespace simvis
