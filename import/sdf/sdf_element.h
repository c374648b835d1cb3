// An element of an SDF file, its place, and its values.
#pragma once

#include <algorithm>
#include <array>
#include <glm/glm.hpp>
#include <memory>
#include <pugixml.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "import/model/import_report.h"
#include "import/model/package_files.h"
#include "scenegraph/language/xml_text.h"

namespace simvis {

/// One file of a world. It lives as long as the elements that refer to it.
struct SdfFile {
  std::shared_ptr<const XmlText> text;
  PackageFiles packages;  ///< as seen from this file
  int version;            ///< of the format: 6 is SDF 1.6
};

/// An element, or none. Values throw InputError at the element if its text is wrong.
class SdfElement {
 public:
  SdfElement() = default;
  SdfElement(pugi::xml_node node, SdfFile& file) : node_(node), file_(&file) {}

  explicit operator bool() const { return static_cast<bool>(node_); }
  SdfFile& file() const { return *file_; }
  std::string_view tag() const { return node_.name(); }
  std::string text() const { return node_.child_value(); }
  std::string attribute(const char* name) const { return node_.attribute(name).value(); }
  /// The attribute `name`. Throws InputError if it is missing or consists of spaces.
  std::string name() const;
  /// The first child of this tag, or none.
  SdfElement child(const char* tag) const { return node_ ? SdfElement(node_.child(tag), *file_) : SdfElement(); }
  /// All children that are elements.
  std::vector<SdfElement> children() const;

  Location at() const { return file_->text->at(node_); }
  /// Throws InputError "FILE:LINE:COLUMN: error: element <TAG> MESSAGE".
  [[noreturn]] void fail(std::string_view message) const;

  /// The text as a number, which may be infinite, or `fallback` if there is no element or no text.
  double number(double fallback) const;
  /// The text as finite numbers, or `fallback` if there is no element or no text.
  glm::dvec2 vector(const glm::dvec2& fallback) const { return vector_of(fallback); }
  glm::dvec3 vector(const glm::dvec3& fallback) const { return vector_of(fallback); }
  /// The text as "true", "false", "1" or "0", or `fallback` if there is no element or no text.
  bool flag(bool fallback) const;
  /// The text as three or four numbers, red, green, blue and opacity; the opacity is 1 if it is missing.
  /// Numbers above 1 are divided by 255, with a warning.
  glm::dvec4 color(const glm::dvec4& fallback, ImportReport& report) const;

 private:
  /// Reads up to values.size() finite numbers and returns how many there are.
  std::size_t read(std::span<double> values) const;
  template <class Vector>
  Vector vector_of(const Vector& fallback) const {
    if (!node_ || text().empty()) return fallback;
    std::array<double, 4> values{};
    Vector vector;
    constexpr std::size_t kSize = sizeof(Vector) / sizeof(double);
    if (read(values) != kSize) fail("has no " + std::to_string(kSize) + " numbers: " + in_quotes(text()));
    for (std::size_t i = 0; i < kSize; ++i) vector[static_cast<int>(i)] = values[i];
    return vector;
  }

  pugi::xml_node node_;
  SdfFile* file_ = nullptr;
};

/// The element <pose> of a parent.
struct SdfPose {
  glm::dmat4 matrix{1.0};
  std::string relative_to;  ///< empty: the parent's default
  SdfElement where;         ///< the element that has the pose, for messages
};

/// Reads the child <pose> of `parent`: radians, or as its attributes say. No child and no text are the identity.
/// Throws InputError for other than finite numbers up to kMaxCoordinate_m.
SdfPose read_sdf_pose(const SdfElement& parent);

}  // namespace simvis
