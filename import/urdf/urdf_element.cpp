#include "import/urdf/urdf_element.h"

#include <string_view>

#include <simvis/attributes.h>
#include <simvis/pose.h>
#include "engine/base/words.h"

namespace simvis {
namespace {

glm::dvec3 scale_of(const UrdfElement& mesh) {
  if (has_one_scale(mesh)) return glm::dvec3(mesh.numbers<1>("scale")[0]);
  const auto [x, y, z] = mesh.numbers<3>("scale", {1, 1, 1});
  return {x, y, z};
}

}  // namespace

std::vector<UrdfElement> UrdfElement::children(const char* tag) const {
  std::vector<UrdfElement> all;
  for (const pugi::xml_node& child : node_.children(tag)) all.emplace_back(*text_, child);
  return all;
}

UrdfElement UrdfElement::first_child() const {
  const auto is_element = [](const pugi::xml_node& child) { return child.type() == pugi::node_element; };
  return {*text_, node_.find_child(is_element)};
}

std::string UrdfElement::says(const std::string& what) const {
  return std::string(tag()) + (name().empty() ? "" : " " + in_quotes(name())) + " " + what;
}

void UrdfElement::fail(const std::string& what) const { fail_at(where(), says(what)); }

double UrdfElement::not_negative(const char* attribute) const {
  const double value = number(attribute, 0);
  if (value < 0) fail("has " + std::string(attribute) + " " + format_number(value) + ", expected at least 0");
  return value;
}

glm::dmat4 UrdfElement::origin() const {
  const UrdfElement own = child("origin");
  const auto [x, y, z] = own.numbers<3>("xyz", {0, 0, 0});
  const auto [roll, pitch, yaw] = own.numbers<3>("rpy", {0, 0, 0});
  return to_matrix({.position_m = {x, y, z}, .roll_rad = roll, .pitch_rad = pitch, .yaw_rad = yaw});
}

// Numbers may have a plus sign, as in all programs that read robots.
bool UrdfElement::parse(const char* attribute, std::span<double> numbers) const {
  const std::string written = text(attribute);
  const std::vector<std::string_view> words = words_of(written);
  if (words.size() != numbers.size()) return false;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const bool has_plus = words[i].starts_with('+') && !words[i].starts_with("+-");
    if (!parse_number(words[i].substr(has_plus ? 1 : 0), numbers[i])) return false;
  }
  return true;
}

void UrdfElement::fail_at_numbers(const char* attribute, std::size_t count) const {
  fail("has " + std::string(attribute) + " " + in_quotes(text(attribute)) + ", expected " + std::to_string(count) +
       (count == 1 ? " finite number" : " finite numbers"));
}

bool has_one_scale(const UrdfElement& mesh) { return words_of(mesh.text("scale")).size() == 1; }

ModelShape read_urdf_shape(const UrdfElement& visual_or_collision) {
  ModelShape shape{.link_from_shape = visual_or_collision.origin()};
  const UrdfElement written = visual_or_collision.child("geometry").first_child();
  const std::string_view kind = written.tag();
  if (kind == "box") {
    const auto [x, y, z] = written.numbers<3>("size");
    shape.size = {x, y, z};
  } else if (kind == "sphere") {
    shape.kind = ModelShape::Kind::sphere;
    shape.size = glm::dvec3(written.numbers<1>("radius")[0]);
  } else if (kind == "cylinder" || kind == "capsule") {
    shape.kind = kind == "capsule" ? ModelShape::Kind::capsule : ModelShape::Kind::cylinder;
    const double radius = written.numbers<1>("radius")[0];
    shape.size = {radius, radius, written.numbers<1>("length")[0]};
  } else if (kind == "mesh") {
    shape.kind = ModelShape::Kind::mesh;
    shape.size = scale_of(written);
  } else {
    visual_or_collision.fail("has no box, sphere, cylinder, capsule or mesh");
  }
  return shape;
}

}  // namespace simvis
