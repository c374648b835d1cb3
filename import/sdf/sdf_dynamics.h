// What an SDF file says of masses, collisions and joints, and a world of gravity and steps.
#pragma once

#include <memory>
#include <utility>

#include "import/model/model_description.h"
#include "import/sdf/sdf_document.h"

namespace simvis {

/// A world or a model as the importer has read it. A link has the name of its insertion point, and a joint that of its
/// element; in front of a link that moves stands one without mass, in the frame of the joint. A link without <inertial>
/// has what SDF gives it: 1 kg and 1 kg m^2, with a warning. In a file that is no single model, a collision that is
/// wrong is left out with a warning, as the importer does with a visual.
///
/// The description throws InputError with the place: a joint of a single model of a type other than fixed, revolute,
/// continuous, hinge and prismatic; a mass, size or damping that is negative or infinite; a mesh that is missing.
class SdfSource : public ModelSource {
 public:
  explicit SdfSource(std::shared_ptr<SdfDocument> document) : document_(std::move(document)) {}
  /// Throws InputError with the place: no world, a step that is too short or too long.
  ModelWorld world() override;

 private:
  ModelDescription describe(ContentPool& pool) override;
  std::shared_ptr<SdfDocument> document_;
};

}  // namespace simvis
