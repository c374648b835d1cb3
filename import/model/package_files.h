// Finds the files that a URDF or an SDF file names, as ROS and Gazebo find them.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <simvis/location.h>
#include <simvis/scene.h>
#include "engine/base/read_fence.h"

namespace simvis {

/// The folders that an environment variable lists, with colons between them. The run's report notes the variable.
std::vector<std::filesystem::path> folders_of_variable(const char* variable);

/// Names have one of these forms; a backslash counts as a slash:
///   package://NAME/REST, $(find NAME)/REST   a file of the ROS package NAME
///   package://FILE                           relative to the folder of the URDF
///   model://NAME/REST                        a file of the Gazebo model NAME
///   PATH, file://PATH                        relative to the folder of the URDF
///
/// Folders of NAME are searched in this order, and the first that has REST counts:
///   1. the folders that the user gave
///   2. package: ROS_PACKAGE_PATH, by the <name> of each package.xml below it;
///               then AMENT_PREFIX_PATH, PREFIX/share/NAME
///      model: GAZEBO_MODEL_PATH, GZ_SIM_RESOURCE_PATH, IGN_GAZEBO_RESOURCE_PATH, then SDF_PATH
///   3. from the URDF's folder upwards: a folder above or beside whose name or <name> in package.xml is NAME; for a
///      model, also one of that name in a folder `models` beside or above
/// A file that is still not found is searched near the URDF: REST, or its last components (at least a folder and the
/// file), in the URDF's folder and the three above it, at last without regard to upper and lower case. This gives a
/// warning for each NAME.
///
/// In a shared folder, such as the home folder (engine/base/read_fence.h), only folders with a file package.xml or
/// model.config are packages, and no file is near. Folders of packages that are found are admitted to the fence of the
/// part, and so is the folder of a file that is found near by.
class PackageFiles {
 public:
  /// `urdf` is the file that names the others, a URDF or an SDF file.
  PackageFiles(const std::filesystem::path& urdf, std::vector<PackageFolder> given);

  /// Empty: there is no such file, see tried(). `where` is the place that names the file, for warnings.
  std::optional<std::filesystem::path> find(const std::string& name, const Location& where);

  /// The file REST of the Gazebo model NAME, as find() finds it, but never another file near by.
  std::optional<std::filesystem::path> find_model_file(const std::string& name, const std::string& rest);

  /// The places that the last find() tried, for messages: "tried A, B, C".
  std::string tried() const;

  /// All packages by name, in the order of find(). A package beside or above the URDF is found up to five folders above
  /// it.
  std::map<std::string, std::filesystem::path> packages();

  /// Their folders, and for those that `colcon build --symlink-install` has made of links, the folders of their
  /// sources.
  Folders package_folders();

  std::vector<std::string> release_warnings() { return std::move(warnings_); }

 private:
  std::optional<std::filesystem::path> find_in_package(const std::string& name, const std::string& rest, bool is_model);
  std::optional<std::filesystem::path> find_beside_or_above(const std::string& name, const std::string& rest,
                                                            bool is_model);
  std::optional<std::filesystem::path> find_near(const std::string& rest, const std::string& subject,
                                                 const Location& where);
  std::optional<std::filesystem::path> try_file(const std::filesystem::path& folder, const std::string& rest);
  std::optional<std::filesystem::path> try_package(const std::filesystem::path& folder, const std::string& rest);
  const std::multimap<std::string, std::filesystem::path>& ros_packages();
  const std::string& declared_name(const std::filesystem::path& folder);
  const std::vector<std::filesystem::path>& packages_in(const std::filesystem::path& folder);

  std::filesystem::path folder_;
  std::vector<PackageFolder> given_;
  std::vector<std::string> tried_, warnings_;
  std::set<std::string> warned_;
  std::optional<std::multimap<std::string, std::filesystem::path>> ros_packages_;
  std::map<std::filesystem::path, std::string> declared_names_;
  std::map<std::filesystem::path, std::vector<std::filesystem::path>> packages_in_;
};

}  // namespace simvis
