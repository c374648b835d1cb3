// Mesh files (.dae .obj .ply .stl) as Assimp reads them, after the checks that Assimp leaves out.
#pragma once

#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace simvis {

/// A file under import. Indices of faces, meshes and materials are within bounds; numbers need not be finite.
struct AssimpFile {
  std::filesystem::path file;
  bool is_collada = false;
  std::unique_ptr<Assimp::Importer> importer;  ///< owns the scene
  const aiScene* scene = nullptr;
  std::vector<std::string> warnings;

  /// Throws InputError "FILE: error: MESSAGE".
  [[noreturn]] void fail(const std::string& message) const;
  /// Adds "FILE: MESSAGE", each once.
  void warn(const std::string& message);
};

/// Faces may have any number of corners. COLLADA comes out Y-up in metres, by its <up_axis> and <unit>; with
/// `ignore_up_axis` by its <unit> alone. All others come out as they are.
/// Throws InputError naming the file: cannot be read, too large, cut off, malformed; with the place where it is known.
AssimpFile read_assimp_file(const std::filesystem::path& file, bool ignore_up_axis);

}  // namespace simvis
