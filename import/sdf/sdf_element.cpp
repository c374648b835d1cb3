#include "import/sdf/sdf_element.h"

#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include <simvis/attributes.h>
#include <simvis/pose.h>
#include "engine/base/words.h"

namespace simvis {
namespace {

// One word as a number, which may be infinite and may have a plus sign.
bool read_sdf_number(std::string_view word, double& value) {
  if (word.starts_with('+')) word.remove_prefix(1);
  const std::optional<double> number = as_number<double>(word);
  if (!number || std::isnan(*number)) return false;
  value = *number;
  return true;
}

}  // namespace

std::string SdfElement::name() const {
  std::string name = attribute("name");
  if (trimmed(name).empty()) fail("has no name, expected an attribute \"name\"");
  return name;
}

std::vector<SdfElement> SdfElement::children() const {
  std::vector<SdfElement> elements;
  for (const pugi::xml_node& node : node_.children()) {
    if (node.type() == pugi::node_element) elements.emplace_back(node, *file_);
  }
  return elements;
}

void SdfElement::fail(std::string_view message) const {
  fail_at(at(), "element <" + std::string(tag()) + "> " + std::string(message));
}

double SdfElement::number(double fallback) const {
  if (!node_ || text().empty()) return fallback;
  double value = 0;
  if (!read_sdf_number(text(), value)) fail("has no number: " + in_quotes(text()));
  return value;
}

std::size_t SdfElement::read(std::span<double> values) const {
  const std::string all = text();
  std::size_t count = 0;
  for (const std::string_view word : words_of(all)) {
    if (count == values.size()) return count + 1;
    if (!read_sdf_number(word, values[count]) || !std::isfinite(values[count])) {
      fail("has " + in_quotes(word) + ", expected finite numbers");
    }
    ++count;
  }
  return count;
}

bool SdfElement::flag(bool fallback) const {
  if (!node_ || text().empty()) return fallback;
  const std::string word = text();
  if (word == "true" || word == "True" || word == "1") return true;
  if (word == "false" || word == "False" || word == "0") return false;
  fail("has " + in_quotes(word) + ", expected true, false, 1 or 0");
}

// Numbers above 1 are those of bytes, as in gz-math's Color::Clamp().
glm::dvec4 SdfElement::color(const glm::dvec4& fallback, ImportReport& report) const {
  if (!node_ || text().empty()) return fallback;
  std::array<double, 4> values{0, 0, 0, 1};
  const std::size_t count = read(values);
  if (count < 3 || count > 4) fail("has no color of three or four numbers: " + in_quotes(text()));
  if (std::ranges::any_of(values, [](double value) { return value > 1; })) {
    report.warn_once(at(), "a colour has numbers above 1, which are divided by 255 as in Gazebo");
  }
  for (double& value : values) value = std::clamp(value > 1 ? value / 255 : value, 0.0, 1.0);
  return {values[0], values[1], values[2], values[3]};
}

SdfPose read_sdf_pose(const SdfElement& parent) {
  SdfPose pose;
  pose.where = parent;
  const SdfElement element = parent.child("pose");
  if (!element) return pose;
  pose.where = element;
  pose.relative_to = element.attribute("relative_to");
  constexpr int kFirstWithRelativeTo = 7;  // older ones say "frame"
  if (element.file().version < kFirstWithRelativeTo) pose.relative_to = element.attribute("frame");
  if (element.text().empty()) return pose;
  const bool is_quaternion = element.attribute("rotation_format") == "quat_xyzw";
  std::array<double, 7> v{};
  const std::string text = element.text();
  if (!parse_numbers(text, std::span(v).first(is_quaternion ? 7 : 6))) {
    element.fail("has no " + std::string(is_quaternion ? "seven" : "six") + " finite numbers: " + in_quotes(text));
  }
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(std::abs(v[i]) <= kMaxCoordinate_m)) {
      element.fail("has a coordinate that is not allowed, expected at most " + format_number(kMaxCoordinate_m) +
                   " m either way");
    }
  }
  const glm::dvec3 position(v[0], v[1], v[2]);
  if (is_quaternion) {
    const glm::dquat quaternion(v[6], v[3], v[4], v[5]);
    const double length = glm::length(quaternion);
    if (!(length > 0 && std::isfinite(length))) element.fail("has a quaternion without length");
    pose.matrix = glm::mat4_cast(quaternion / length);
    pose.matrix[3] = glm::dvec4(position, 1);
  } else if (element.attribute("degrees") == "true" || element.attribute("degrees") == "1") {
    pose.matrix = matrix_from_degrees(position, v[3], v[4], v[5]);
  } else {
    pose.matrix = to_matrix({.position_m = position, .roll_rad = v[3], .pitch_rad = v[4], .yaw_rad = v[5]});
  }
  return pose;
}

}  // namespace simvis
