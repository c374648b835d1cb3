// An element of a URDF file: its attributes as checked numbers, and its place for errors and warnings.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <pugixml.hpp>
#include <span>
#include <string>
#include <vector>

#include "import/model/model_description.h"
#include "scenegraph/language/xml_text.h"

namespace simvis {

/// The text of the file outlives it. One that is not there has no attributes and no children.
class UrdfElement {
 public:
  UrdfElement(const XmlText& text, pugi::xml_node node) : text_(&text), node_(node) {}
  explicit operator bool() const { return static_cast<bool>(node_); }

  const char* tag() const { return node_.name(); }
  UrdfElement child(const char* tag) const { return {*text_, node_.child(tag)}; }
  std::vector<UrdfElement> children(const char* tag) const;
  /// Text may stand before it.
  UrdfElement first_child() const;

  bool has(const char* attribute) const { return static_cast<bool>(node_.attribute(attribute)); }
  /// As written; empty if there is none.
  std::string text(const char* attribute) const { return node_.attribute(attribute).value(); }
  std::string name() const { return text("name"); }
  Location where() const { return text_->at(node_); }

  /// `TAG "NAME" WHAT`, without a name if there is none.
  std::string says(const std::string& what) const;
  /// Throws InputError at the place of the element: what it says.
  [[noreturn]] void fail(const std::string& what) const;

  /// The numbers of an attribute, which are finite. All below throw InputError at the element for anything else.
  template <std::size_t count>
  std::array<double, count> numbers(const char* attribute) const {
    std::array<double, count> numbers{};
    if (!parse(attribute, numbers)) fail_at_numbers(attribute, count);
    return numbers;
  }
  /// Those given if it is missing.
  template <std::size_t count>
  std::array<double, count> numbers(const char* attribute, const std::array<double, count>& absent) const {
    return has(attribute) ? numbers<count>(attribute) : absent;
  }
  double number(const char* attribute, double absent) const { return numbers<1>(attribute, {absent})[0]; }
  /// Whether the attribute is as many numbers; otherwise they are unspecified.
  bool parse(const char* attribute, std::span<double> numbers) const;
  double not_negative(const char* attribute) const;
  /// The matrix parent_from_child of <origin>; the identity if there is none.
  glm::dmat4 origin() const;

 private:
  [[noreturn]] void fail_at_numbers(const char* attribute, std::size_t count) const;

  const XmlText* text_;
  pugi::xml_node node_;
};

/// Whether the scale of a <mesh> is one number, which counts for all axes.
bool has_one_scale(const UrdfElement& mesh);

/// The shape of the first element of a <geometry>, at the <origin> beside it, with sizes as they are written: also 0 or
/// less. A mesh has its scale, and no file. Throws InputError at the geometry: it has no such element.
ModelShape read_urdf_shape(const UrdfElement& visual_or_collision);

}  // namespace simvis
