// The element `models`: the bodies of an SDF, MJCF or URDF file stand, fall and swing as physics says.
//
//   <element type="models" name="BODIES" insert_at="WORLD"/>
//
// Parameters  x_LINK y_LINK z_LINK (m), roll_LINK pitch_LINK yaw_LINK (deg), all live: what moves a body that nothing
//             holds, from its place in the file. LINK is the insertion point of its first link. The physics writes
//             them, and the values of the elements `joint` behind; a value that is set puts the body there, at rest.
//             Behind them target_JOINT, as of an element `robot`, for joints that the file's actuators drive.
#pragma once

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include <simvis/command.h>
#include <simvis/element.h>
#include "elements/dynamics/robot.h"
#include "import/model/model_description.h"

namespace simvis {

class ModelsElement : public Element, public Stateful {
 public:
  /// Throws InputError: no physics; the part has no links or is scaled; what its format and robot_description.h say;
  /// a body that moves and has no mass.
  explicit ModelsElement(const ElementContext& context);
  void update(ParameterView values) override;
  void adapt_parameters(std::vector<AttributeSpec>& live_rows) const override;
  bool moves_itself() const override { return !bodies_.empty(); }
  void advance(std::int64_t time_ns, std::span<double> values) override;
  void archive(StateArchive& state) override {
    for (const Body& body : bodies_) body.robot->archive(state);
  }

 private:
  struct Body {
    std::unique_ptr<RobotElement> robot;
    bool is_free = false;          // the first rows are those of its pose
    std::size_t rows = 0;          // of this body
    std::vector<double> values{};  // as RobotElement has them: the pose always stands in front
  };
  void add(const ElementContext& context, const ModelBody& body, RobotDescription description,
           const std::string& prefix);
  void constrain(const ElementContext& context, const ModelDescription& file);
  void keep_apart(const ElementContext& context, const ModelContacts& contacts);
  struct FoundLink {
    RobotElement* robot = nullptr;  // null: no body has it
    int link = -1, part = 0;
    glm::dmat4 link_from_part{1.0};
  };
  FoundLink find_link(const std::string& name) const;

  std::vector<Body> bodies_;
  std::vector<AttributeSpec> rows_;    // of all bodies
  std::deque<std::string> row_names_;  // of poses in rows_
};

}  // namespace simvis
