// The questions of sensors to the physics of a scene: contacts and loads of joints. The element `physics` inserts an
// object of this class into the scene, where find_physics() finds it.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/node.h>
#include <simvis/pose.h>
#include <simvis/scene.h>

namespace simvis {

class SensedPhysics : public Group {
 public:
  /// Where the body at an insertion point touches others: all of an element's body, or a link of a robot. Empty if none
  /// stands there.
  virtual std::optional<std::vector<Contact>> contacts_at(std::string_view point) const = 0;
  /// The elements of type joint whose loads are measured in all further steps; no others are.
  virtual void measure_loads(std::set<std::string, std::less<>> joints) = 0;
  /// Empty if no robot of physics has a joint of this element. Zero before the first step.
  virtual std::optional<JointLoad> load_of(std::string_view joint) const = 0;
};

/// The physics of a scene; null if it has none.
std::shared_ptr<SensedPhysics> find_physics(const Scene& scene);

}  // namespace simvis
