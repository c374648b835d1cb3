// Reads a URDF file with liburdfdom and adds the checks that liburdfdom leaves out.
#pragma once

#include <urdf_model/model.h>

#include <map>
#include <memory>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <simvis/part_importer.h>
#include "import/model/package_files.h"
#include "import/urdf/urdf_leniency.h"
#include "scenegraph/language/xml_text.h"

namespace simvis {

/// A robot whose links form a tree: every joint has its two links, and every link except the root has one joint above
/// it. Numbers are finite.
struct UrdfFile {
  XmlText text;  ///< its document is the mended one
  std::shared_ptr<const urdf::ModelInterface> robot;
  UrdfMending mending;
  /// The first element <TAG name="NAME"> directly below <robot>, by tag and name.
  std::map<std::pair<std::string, std::string>, pugi::xml_node> named{};

  /// Returns the place of a named element, or else the file.
  Location at(std::string_view tag, std::string_view name) const;
  /// Throws InputError at that place: "FILE:LINE:COLUMN: error: TAG "NAME" MESSAGE".
  [[noreturn]] void fail(std::string_view tag, std::string_view name, const std::string& message) const;
};

/// The robot's text, without zero bytes at its end, expanded if it is a xacro file. What is read otherwise than written
/// gives a warning. Throws InputError as expand_xacro(), and for arguments of a file that is no xacro.
XmlText read_urdf_text(const ImportRequest& request, PackageFiles& packages, std::vector<std::string>& warnings);

/// Mends the document, see urdf_leniency.h, and reads it.
/// Throws InputError with the place, or with the file and liburdfdom's message, for links or joints that break the
/// format, no root link or several root links, and cycles.
UrdfFile read_urdf(XmlText text);

}  // namespace simvis
