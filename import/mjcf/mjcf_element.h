// An element of an MJCF model with the defaults of its class, and the model's files.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <list>
#include <map>
#include <optional>
#include <pugixml.hpp>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scenegraph/language/xml_text.h"

namespace simvis {

class MjcfModel;

/// How deep bodies, and classes of defaults, may be nested over all files.
inline constexpr int kMaxMjcfDepth = 200;

/// An element, with the class whose defaults apply to it.
class MjcfElement {
 public:
  MjcfElement(pugi::xml_node node, const XmlText& text, const MjcfModel& model, std::string childclass)
      : node_(node), text_(&text), model_(&model), childclass_(std::move(childclass)) {}

  std::string_view tag() const { return node_.name(); }
  const MjcfModel& model() const { return *model_; }
  Location at() const { return text_->at(node_); }
  /// Throws InputError "FILE:LINE:COLUMN: error: element <TAG> MESSAGE".
  [[noreturn]] void fail(const std::string& message) const;

  /// The attribute as written, or else that of the element's class; empty: neither has it.
  std::optional<std::string> find(const char* name) const;
  /// As find(), without the defaults.
  std::optional<std::string> written(const char* name) const;
  std::string text(const char* name, const std::string& fallback = {}) const { return find(name).value_or(fallback); }
  /// The numbers of an attribute, which are finite. Empty: it is not there. Throws InputError for other than `least` to
  /// `most` numbers.
  std::vector<double> numbers(const char* name, std::size_t least, std::size_t most) const;
  /// The class whose defaults should apply, if the model does not define it.
  std::string unknown_class() const;
  double number(const char* name, double fallback) const;
  glm::dvec3 vector(const char* name, const glm::dvec3& fallback) const;
  bool flag(const char* name, bool fallback) const;

  /// The children, with those of included files in their places.
  std::vector<MjcfElement> children() const;
  pugi::xml_object_range<pugi::xml_attribute_iterator> attributes() const { return node_.attributes(); }

 private:
  pugi::xml_node node_;
  const XmlText* text_;
  const MjcfModel* model_;
  std::string childclass_;
};

/// A file as MJCF writes it: backslashes separate folders, as in MuJoCo.
std::filesystem::path mjcf_path(std::string name);

/// A model with the files that it includes.
class MjcfModel {
 public:
  /// Throws InputError with the place: malformed XML, another root than <mujoco>, included files that are missing or in
  /// a circle.
  explicit MjcfModel(const std::filesystem::path& file);

  /// The children of <mujoco> with this tag, over all files, such as each <worldbody>.
  std::vector<MjcfElement> sections(std::string_view tag) const;
  std::vector<MjcfElement> top() const;
  const std::filesystem::path& file() const { return file_; }
  std::string name() const;

  // From <compiler>.
  bool is_degrees = true, autolimits = true, strips_path = false;
  std::string eulerseq = "xyz";
  std::filesystem::path mesh_folder, texture_folder;
  /// The file of an asset, without the folders in its name if `strips_path` says so. Where the folder has no such file,
  /// it is searched for the included file that has the asset: as MuJoCo 4.0.0 does, in the folder below `folder` that
  /// is called as that of the included file; then beside the included file, in the folder that <compiler> names and in
  /// its own. If it is nowhere, the path in `folder`.
  std::filesystem::path asset_file(const MjcfElement& asset, const std::filesystem::path& folder,
                                   const std::string& name) const;

  /// Whether a <flag> of <option> disables what `flag` names. Disabling "constraint" also disables contact, equality,
  /// frictionloss and limit; disabling "passive" also disables spring and damper.
  bool is_off(std::string_view flag) const { return off_.contains(flag); }

  /// The default of an attribute: of the class, or of the classes around it.
  std::optional<std::string> default_of(const std::string& name, std::string_view tag, const char* attribute) const;
  bool has_class(const std::string& name) const { return classes_.contains(name); }
  const XmlText& include(const MjcfElement& include, const std::string& file) const;

  /// About the texts that have been read, each with its place.
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  struct DefaultClass {
    std::string outer;
    std::map<std::string, std::map<std::string, std::string, std::less<>>, std::less<>> attributes;  // by tag
  };
  void read_compiler();
  void read_flags();
  void read_defaults(const MjcfElement& element, const std::string& outer, int depth);

  std::filesystem::path file_;
  struct Included {
    const XmlText* text;
    std::string place;  // of the element that includes it
  };
  mutable std::list<XmlText> texts_;  // the model first
  mutable std::vector<std::string> warnings_;
  mutable std::map<std::filesystem::path, Included> included_;
  std::map<std::string, DefaultClass, std::less<>> classes_;
  std::set<std::string, std::less<>> off_;  // flags
};

/// The frame of an element: `pos` and one of quat, axisangle, euler, xyaxes and zaxis. Throws InputError for an
/// orientation without length.
glm::dmat4 mjcf_pose(const MjcfElement& element);

}  // namespace simvis
