// The element `models`: the models of an SDF world stand, fall and swing as physics says.
//
//   <element type="models" name="BODIES" insert_at="WORLD"/>
//
// Parameters  x_LINK y_LINK z_LINK (m), roll_LINK pitch_LINK yaw_LINK (deg), all live: what moves a body that nothing
//             holds, from its place in the file. LINK is the insertion point of its first link. The physics writes
//             them, and the values of the elements `joint` behind; a value that is set puts the body there, at rest.
#pragma once

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include <simvis/command.h>
#include <simvis/element.h>
#include "elements/dynamics/robot.h"
#include "import/sdf/sdf_dynamics.h"

namespace simvis {

class ModelsElement : public Element {
 public:
  /// Throws InputError: no physics; the part is no SDF file or scaled; what sdf_dynamics.h and robot_description.h say;
  /// a body that moves and has no mass.
  explicit ModelsElement(const ElementContext& context);
  void update(ParameterView values) override;
  void adapt_parameters(std::vector<AttributeSpec>& live_rows) const override;
  bool moves_itself() const override { return !bodies_.empty(); }
  void advance(std::int64_t time_ns, std::span<double> values) override;

 private:
  void add(const ElementContext& context, const SdfBody& body, RobotDescription description, const std::string& prefix);

  std::vector<std::unique_ptr<RobotElement>> bodies_;
  std::vector<RobotElement*> free_;    // those with parameters
  std::vector<AttributeSpec> rows_;    // theirs
  std::deque<std::string> row_names_;  // of rows_
};

}  // namespace simvis
