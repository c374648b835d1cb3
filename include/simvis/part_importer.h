// Part files of different formats. A format is one pair of files that registers itself for its file endings.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/scene.h>
#include <simvis/version.h>

namespace simvis {

enum class UpAxis : std::uint8_t { y, z };

/// What an importer is told.
struct ImportRequest {
  std::filesystem::path file;
  bool up_given = false;  ///< the part's `up` attribute was written
  UpAxis up = UpAxis::z;  ///< and says this
};

/// Reads a part. Meshes, textures and materials go through the pool.
/// Throws InputError, "FILE: error: what is wrong, and what was expected", and never crashes on a broken file.
using PartImporter = PartContent (*)(const ImportRequest& request, ContentPool& pool);

/// A static object of this type makes a format known. `endings` are lower case with the dot: {".gltf", ".glb"}. An
/// ending that is taken is refused as a type is, see ElementRegistration.
struct PartImporterRegistration {
  PartImporterRegistration(std::vector<std::string> endings, PartImporter importer,
                           std::string_view built_for = kHeaderVersion);
};

/// The importer for a file, by its ending in any case. Null when there is none.
PartImporter find_part_importer(const std::filesystem::path& file);
std::vector<std::string> known_part_endings();

}  // namespace simvis
