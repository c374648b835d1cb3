// An SDF file with all that it includes, as its importer and physics use it.
#pragma once

#include <memory>

#include "import/model/model_meshes.h"
#include "import/sdf/sdf_model.h"
#include "import/sdf/sdf_poses.h"
#include "import/sdf/sdf_reader.h"
#include "import/sdf/sdf_tree.h"

namespace simvis {

/// Its parts refer to each other, so that it stays where it is.
struct SdfDocument {
  explicit SdfDocument(const ImportRequest& request) : files(request.file, request.packages) {}
  SdfDocument(const SdfDocument&) = delete;
  SdfDocument& operator=(const SdfDocument&) = delete;

  SdfFiles files;
  std::shared_ptr<ModelMeshes> meshes = std::make_shared<ModelMeshes>();  ///< of all visuals and collisions
  SdfContent sdf;
  SdfPoses poses;
  SdfNames names;
  SdfTree tree;
};

}  // namespace simvis
