// Importers of part files. A format is one pair of files that registers itself for its file extensions.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/scene.h>
#include <simvis/version.h>

namespace simvis {

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
  std::vector<PackageFolder> packages{};  ///< searched before all other places where packages are
};

/// Reads a part. Meshes, textures and materials go through the pool.
///
/// Errors   InputError, "FILE: error: what is wrong, and what was expected". A broken file must not crash the importer.
/// Threads  several simulations may call it in different threads at once, each with its own pool.
using PartImporter = PartContent (*)(const ImportRequest& request, ContentPool& pool);

/// A static object of this type registers a format. `endings` are lower case with the dot: {".gltf", ".glb"}. An
/// extension that is taken is refused in the same way as a type, see ElementRegistration.
struct PartImporterRegistration {
  /// `built_for` is the version of the headers that the caller is compiled with.
  PartImporterRegistration(std::vector<std::string> endings, PartImporter importer,
                           std::string_view built_for = kHeaderVersion);
};

/// The importer for a file, by its extension in any case. Null if there is none.
PartImporter find_part_importer(const std::filesystem::path& file);
/// All registered extensions, in lower case with the dot.
std::vector<std::string> known_part_endings();

}  // namespace simvis
