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

std::string label(const SeenThing& thing, const std::string& type) {
  const glm::dvec3 heading = thing.optical_from_box[0];  // the x axis of the box
  const glm::dvec3 bottom = thing.centre_m - 0.5 * thing.size_m.z * thing.optical_from_box[2];
  const double rotation = std::atan2(-heading.z, heading.x);
  const double alpha = wrapped(rotation - std::atan2(bottom.x, bottom.z));
  std::array<char, 512> text{};
  std::snprintf(text.data(), text.size(), " %.2f %d %.4f %.2f %.2f %.2f %.2f %.4f %.4f %.4f %.4f %.4f %.4f %.4f\n",
                thing.truncated, occlusion(thing.visible_fraction), alpha, thing.picture.x_min, thing.picture.y_min,
                thing.picture.x_max - 1, thing.picture.y_max - 1, thing.size_m.z, thing.size_m.y, thing.size_m.x,
                bottom.x, bottom.y, bottom.z, rotation);
  return type + text.data();
}

}  // namespace

std::string kitti_labels(const SeenView& view, const std::map<std::uint32_t, std::string>& classes) {
  std::string lines;
  for (const SeenThing& thing : view.things) {
    if (thing.visible_pixels > 0) lines += label(thing, type_of(thing.semantic, classes));
  }
  return lines;
}

}  // namespace simvis
