// The element `robot`: the joints of a URDF, SDF or MJCF part move as drives, gravity and contacts say.
//
//   <element type="robot" name="ARM_BODY" insert_at="ARM" control="position"/>
//
// Parameters  x y z (m), roll pitch yaw (deg): the place of the base, as of an element `body`; and target_JOINT for
// each
//             driven joint: deg or m, deg/s or m/s, N m or N; and effort_JOINT (N m or N) for each servo. The physics
//             writes the place of a free base and the values of the elements `joint`; a value that is set from outside
//             puts base or joint there, at rest.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <simvis/node.h>
#include "elements/dynamics/dynamic_scene.h"
#include "elements/dynamics/robot_description.h"
#include "elements/joint.h"
#include "elements/pose.h"
#include "elements/pose_rows.h"

namespace simvis {

enum class JointControl { position, servo, speed, effort, none, file };

struct ModelPart;

class RobotElement : public Element, private DynamicObject {
 public:
  /// Throws InputError: no physics; the part is no URDF robot or SDF model, is scaled, or has a robot already; a list
  /// names a joint that is not there, or two lists name one joint; what robot_description.h says.
  explicit RobotElement(const ElementContext& context);
  /// A body of the file at whose insertion point it stands; `prefix` stands in front of the file's names.
  RobotElement(const ElementContext& context, RobotDescription description, const std::string& prefix);
  ~RobotElement() override;
  void update(ParameterView values) override;
  void adapt_parameters(std::vector<AttributeSpec>& live_rows) const override;
  bool moves_itself() const override { return !desc_.fixed_base; }
  void advance(std::int64_t time_ns, std::span<double> values) override;

  const DynamicObject& object() const { return *this; }
  /// The link of the body in which a link of the file is, by its name there; null: not in this body.
  const RobotDescription::NamedLink* find_link(const std::string& name_in_file) const;
  /// The number of a link that find_link() returned, see WorldPart.
  int part_of(const RobotDescription::NamedLink& link) const { return static_cast<int>(&link - links_.data()); }
  /// A constraint or a contact's exclusion that the file says needs a jointed body, also where nothing moves in it.
  void require_articulation() { is_articulation_ = true; }
  /// A joint with a parameter for its target.
  struct DrivenJoint {
    std::string name;                ///< in the file
    std::string parameter;           ///< "target_JOINT"
    std::string effort_parameter{};  ///< of a servo: "effort_JOINT"; empty: the joint has none
    enum class Kind : std::uint8_t { position, velocity, effort } kind = Kind::position;
    double unit = 1;          ///< of the parameter, in SI units
    double min = 0, max = 0;  ///< of the parameter
    double rounding = 0;      ///< as AttributeSpec::rounding of the parameter
  };
  std::vector<DrivenJoint> driven_joints() const;
  /// Whether a joint of the file, by its name there, follows another one.
  bool follows(const std::string& joint) const;
  /// Where a joint stands now, in SI units; its name is one of driven_joints().
  double joint_position(const std::string& joint) const;
  void set_carrier(std::string element) { carrier = std::move(element); }

 private:
  RobotElement(const ElementContext& context, const ModelPart& part);
  struct Joint {
    RobotJoint described;
    JointControl control = JointControl::none;
    double max_effort = 0, max_speed = 0;  // SI units
    double to_si = 1;                      // from deg or m to rad or m
    double target = 0;                     // SI units
    double feed_forward = 0;               // of a servo, SI units
    double start = 0;                      // SI units
    std::string row{}, row_text{}, row_default{};
    std::string effort_row{}, effort_text{};    // of a servo
    std::shared_ptr<JointDriver> driver{};      // null: no element shows it
    std::shared_ptr<PoseDriver> ball_driver{};  // the same of a ball, which nothing drives
    bool is_ball() const { return described.model.kind == ModelJoint::Kind::ball; }
  };
  void read_joints(const ElementContext& context, const std::vector<RobotJoint>& described, const std::string& prefix);
  void read_control(const ElementContext& context, Joint& joint) const;
  void connect(const ElementContext& context, const std::string& prefix, Joint& joint);
  void connect_ball(const ElementContext& context, const std::string& prefix, Joint& joint);
  static bool is_effort(const Joint& joint);
  static double target_at_start(const Joint& joint);
  static AttributeSpec row_of_file(const Joint& joint, AttributeSpec row);
  static JointDrive drive_of_file(const Joint& joint);
  AttributeSpec row_of(const Joint& joint) const;
  static AttributeSpec effort_row_of(const Joint& joint);
  double start_of(const Joint& joint) const;
  JointDrive drive_of(const DynamicsWorld& world, const Joint& joint) const;

  std::size_t enter(DynamicsWorld& world, const glm::dmat4& world_from_point) override;
  std::optional<int> link_at(std::string_view insertion_point) const override;
  glm::dmat4 body_from_point(std::string_view insertion_point) const override;
  bool has_any(std::string_view insertion_point) const override;
  bool has_part(std::string_view insertion_point, int link) const override;
  void begin_steps(DynamicsWorld& world, const glm::dmat4& world_from_point) override;
  void before_step(DynamicsWorld& world, double share) override;
  DynamicParts parts() const override {
    return {.kind = desc_.fixed_base ? BodyKind::fixed : BodyKind::dynamic,
            .mass = &desc_.mass,
            .shapes = desc_.shapes,
            .links = desc_.links};
  }
  std::string point_of(int link) const override {
    const auto named = std::ranges::find(links_, link, &RobotDescription::NamedLink::link);
    return named == links_.end() ? point : named->name;
  }

  std::shared_ptr<DynamicScene> dynamic_;
  std::shared_ptr<Transform> transform_;
  ArticulationDesc desc_;
  std::vector<Joint> joints_;
  std::vector<RobotDescription::NamedLink> links_;  // by insertion point
  double gain_per_s_;
  double stiffness_ = 0, damping_ = 0;  // of servos, SI units
  bool has_weight_, has_drives_;
  bool is_whole_part_;  // not a body within it
  bool is_articulation_ = false;
  std::string prefix_;
  bool entered_ = false, was_set_ = false;
  glm::dmat4 world_from_parent_{1.0};
  std::array<double, kPoseValues> written_{};
};

}  // namespace simvis
