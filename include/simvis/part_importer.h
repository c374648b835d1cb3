// Importers of part files. A format is one pair of files that registers itself for its file extensions.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/content_pool.h>
#include <simvis/export.h>
#include <simvis/node.h>
#include <simvis/version.h>

namespace simvis {

struct PartAnimations;
class ModelSource;

/// The folder of a ROS package or Gazebo model, for file names of the form package://NAME/... and model://NAME/...
struct PackageFolder {
  std::string name;              ///< the package's or model's name
  std::filesystem::path folder;  ///< must exist
};

/// What belongs into one group of a part's graph.
struct ShapesOfGroup {
  GroupPtr group;              ///< empty, below PartContent::root
  std::vector<NodePtr> nodes;  ///< its children
};

/// Reads the shapes that an importer has left out, and returns what belongs into the groups that it left empty. It adds
/// its warnings, each with the file's name. A call that throws may be repeated. Throws InputError as the importer, also
/// if the file has changed.
using ShapeReader = std::function<std::vector<ShapesOfGroup>(ContentPool& pool, std::vector<std::string>& warnings)>;

/// The content of a part file.
struct PartContent {
  NodePtr root;                       ///< may have several parents
  std::vector<std::string> warnings;  ///< for people, each with the file's name
  std::vector<std::string> commands;  ///< embedded commands, XML text, in the order found
  std::filesystem::path file;         ///< the canonical name, empty for a shape; set by Scene
  std::vector<std::string> points;    ///< names of the insertion points in the graph, in order; set by Scene
  /// Animations of the nodes of `root`; null: there are none.
  std::shared_ptr<const PartAnimations> animations;
  /// What the file says of links, joints and masses, for physics; null: nothing. SimVis' own formats alone have it.
  std::shared_ptr<ModelSource> model;
  /// The graph has all but the shapes and their materials; this reads them. Empty: nothing is left out.
  ShapeReader read_shapes;
};

/// The axis of a file that points up.
enum class UpAxis : std::uint8_t {
  y,  ///< +y is up
  z   ///< +z is up
};

/// The input of an importer.
struct ImportRequest {
  std::filesystem::path file;             ///< the part's file
  bool up_given = false;                  ///< the part's `up` attribute was written
  UpAxis up = UpAxis::z;                  ///< its value
  std::string xacro_arguments{};          ///< the part's `xacro_arguments` attribute; empty: none
  double wall_height_m = 2.5;             ///< the part's `wall_height` attribute, above 0
  std::vector<PackageFolder> packages{};  ///< searched before all other places where packages are
  /// The part's `missing_visuals` is "any": a robot may lack most of its visuals, or all.
  bool allow_missing_visuals = false;
  /// The importer may leave the shapes to PartContent::read_shapes, so that their files need not be read.
  bool postpone_shapes = false;
};

/// Reads a part. Meshes, textures and materials go through the pool.
///
/// Errors   InputError, "FILE: error: what is wrong, and what was expected". A broken file must not crash the importer.
/// Threads  several simulations may call it in different threads at once, each with its own pool.
using PartImporter = PartContent (*)(const ImportRequest& request, ContentPool& pool);

/// A static object of this type registers a format. `endings` are lower case with the dot: {".gltf", ".glb"}. An
/// extension that is taken is refused in the same way as a type, see ElementRegistration.
struct SIMVIS_API PartImporterRegistration {
  /// `built_for` is the version of the headers that the caller is compiled with.
  PartImporterRegistration(std::vector<std::string> endings, PartImporter importer,
                           std::string_view built_for = kHeaderVersion);
};

/// The importer for a file, by its extension in any case. Null if there is none.
SIMVIS_API PartImporter find_part_importer(const std::filesystem::path& file);
/// All registered extensions, in lower case with the dot.
SIMVIS_API std::vector<std::string> known_part_endings();

}  // namespace simvis
