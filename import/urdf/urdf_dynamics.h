// What a URDF file says of masses, collisions and drives. Parts without physics leave it out.
#pragma once

#include <memory>
#include <string_view>
#include <utility>

#include <simvis/part_importer.h>
#include "import/model/model_description.h"
#include "import/model/model_meshes.h"
#include "import/urdf/urdf_file.h"

namespace simvis {

/// A robot as the importer has read it, with what its text says of dynamics, strictly: its description throws
/// InputError for a number that is none; a mass, size, damping or friction that is negative; a mesh that is missing.
class UrdfSource : public ModelSource {
 public:
  UrdfSource(ImportRequest request, UrdfFile file) : request_(std::move(request)), file_(std::move(file)) {}
  /// Of all visuals and collisions.
  ModelMeshes& meshes() { return *meshes_; }
  const UrdfFile& file() const { return file_; }
  /// Throws InputError: a URDF file has no gravity and no step.
  ModelWorld world() override;
  std::string_view urdf() const override { return file_.text->source().text(); }

 private:
  ModelDescription describe(ContentPool& pool) override;
  ImportRequest request_;
  UrdfFile file_;
  std::shared_ptr<ModelMeshes> meshes_ = std::make_shared<ModelMeshes>();
};

}  // namespace simvis
