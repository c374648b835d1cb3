// A URDF file as liburdfdom reads it, after the checks that it leaves out.
#pragma once

#include <urdf_model/model.h>

#include <filesystem>
#include <string>
#include <string_view>

#include "scenegraph/language/xml_text.h"

namespace simvis {

/// A robot whose links are a tree under its root: every joint has its two links, every link but the root one joint
/// above it. Numbers are finite.
struct UrdfFile {
  XmlText text;
  std::shared_ptr<const urdf::ModelInterface> robot;

  /// The place of the element <TAG name="NAME"> right below <robot>, or of the file.
  Location at(std::string_view tag, std::string_view name) const;
  /// Throws InputError there: "FILE:LINE:COLUMN: error: TAG "NAME" MESSAGE".
  [[noreturn]] void fail(std::string_view tag, std::string_view name, const std::string& message) const;
};

/// Throws InputError with the place, or with the file and liburdfdom's own words: malformed XML, xacro that was not
/// expanded, links or joints that break the format, no root link or several, cycles.
UrdfFile read_urdf(const std::filesystem::path& file);

}  // namespace simvis
