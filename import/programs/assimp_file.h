// A COLLADA file while Assimp reads it.
#pragma once

#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <memory>
#include <optional>

#include "engine/base/input_file.h"
#include "import/programs/part_source.h"

namespace simvis {

class ColladaArchive;

/// A file during import. The indices of faces, meshes and materials are within bounds; numbers need not be finite.
struct AssimpFile : PartSource {
  std::unique_ptr<Assimp::Importer> importer;  ///< owns the scene
  const aiScene* scene = nullptr;
  std::optional<Bytes> bytes;                     ///< those of the document in an archive
  std::shared_ptr<const ColladaArchive> archive;  ///< null: the file is none
};

}  // namespace simvis
