// A mesh file while Assimp reads it, with its warnings and its errors.
#pragma once

#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <simvis/location.h>
#include "engine/base/input_file.h"

namespace simvis {

class ColladaArchive;

/// A file during import. The indices of faces, meshes and materials are within bounds; numbers need not be finite.
struct AssimpFile {
  std::filesystem::path file;
  bool is_collada = false;
  std::unique_ptr<Assimp::Importer> importer;  ///< owns the scene
  const aiScene* scene = nullptr;
  bool has_colors = true;      ///< false: the vertex colours of the scene are none
  std::optional<Bytes> bytes;  ///< the file's own, if they have been read; those of the document in an archive
  std::shared_ptr<const ColladaArchive> archive;  ///< null: the file is none
  std::optional<std::string> prepared;  ///< what Assimp reads in place of the file, if it would misread the file
  std::vector<std::string> warnings;

  /// Throws InputError "FILE: error: MESSAGE".
  [[noreturn]] void fail(const std::string& message) const;
  /// Adds the warning "FILE: MESSAGE". Equal warnings are added once.
  void warn(const std::string& message);
  /// Adds the warning "FILE:LINE:COLUMN: MESSAGE".
  void warn_at(const Location& where, const std::string& message);
};

}  // namespace simvis
