// The elements that push bodies: each exerts a force and a torque on the body, or on the link of a robot, at whose
// insertion point it stands. To add one, write a class in a pair of files of elements/dynamics/forces/.
#pragma once

#include <memory>

#include <simvis/element.h>
#include <simvis/pose.h>
#include "elements/dynamics/dynamic_scene.h"
#include "scenegraph/language/attribute_rows.h"

namespace simvis {

/// Limits of attributes that such elements share. The forces and torques of finite values are finite.
inline constexpr AttributeLimits kPushedPlace{.min = -kMaxCoordinate_m, .max = kMaxCoordinate_m},
    kPushingForce{.min = -1e12, .max = 1e12}, kLagTime{.min = 0, .max = 1e6};

class WrenchElement : public Element, public WrenchSource {
 public:
  ~WrenchElement() override;

 protected:
  /// Throws InputError at the command: no physics, no body at the insertion point, or one that no force moves.
  explicit WrenchElement(const ElementContext& context);
  /// The body or link at the insertion point of the command, for checks in constructors.
  LinkParts body(const ElementContext& context) const;

 private:
  std::shared_ptr<DynamicScene> dynamic_;
};

}  // namespace simvis
