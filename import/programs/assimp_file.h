// A mesh file while Assimp reads it.
#pragma once

#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <memory>
#include <optional>
#include <string>

#include "engine/base/input_file.h"
#include "import/programs/part_source.h"

namespace simvis {

class ColladaArchive;

/// A file during import. The indices of faces, meshes and materials are within bounds; numbers need not be finite.
struct AssimpFile : PartSource {
  bool is_collada = false;
  std::unique_ptr<Assimp::Importer> importer;  ///< owns the scene
  const aiScene* scene = nullptr;
  std::optional<Bytes> bytes;                     ///< those of the document in an archive
  std::shared_ptr<const ColladaArchive> archive;  ///< null: the file is none
  std::optional<std::string> prepared;  ///< what Assimp reads in place of the file, if it would misread the file
};

}  // namespace simvis
