// What an MJCF model says of masses, collisions, joints and actuators.
#pragma once

#include <memory>
#include <utility>

#include "import/mjcf/mjcf_tree.h"
#include "import/model/model_description.h"

namespace simvis {

/// A model as the importer has read it. Links have the names of their insertion points, joints those of their elements.
/// The world and the bodies without a joint above them are one static body; all that joints hold at these is a second
/// one; each free joint begins another. Where several joints move a body, links without mass stand between them.
///
/// Masses     <inertial>, or else the solids of the geoms, by mass or density; mended by <compiler> boundmass,
///            boundinertia and balanceinertia; scaled to its settotalmass.
/// Joints     hinge and slide: limits, damping, friction, a spring, armature. Ball: damping and
///            a spring.
/// Drives     actuators at joints: motor, position, velocity, and general with an affine bias.
/// Contacts   geoms by contype and conaffinity; a body and its parent, each with what is welded to it, and what
///            <exclude> names, stay apart. Of two geoms the larger friction counts.
/// Equality   joint (a line), connect and weld.
/// Flags      what <flag> of <option> disables is not there: gravity, contact, limit, equality, frictionloss, spring,
///            damper, actuation, and constraint or passive for several of them.
///
/// What physics does otherwise than MuJoCo gives one warning for each kind.
class MjcfSource : public ModelSource {
 public:
  explicit MjcfSource(std::shared_ptr<const MjcfTree> tree) : tree_(std::move(tree)) {}
  /// <option>: gravity, unless a flag disables it, and step, with MuJoCo's defaults.
  ModelWorld world() override;

 private:
  ModelDescription describe(ContentPool& pool) override;
  std::shared_ptr<const MjcfTree> tree_;
};

}  // namespace simvis
