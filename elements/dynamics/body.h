// The element `body`: the part at which it stands becomes a rigid body.
//
//   <element type="body" name="BALL_BODY" insert_at="BALL" shape="sphere" mass="2" restitution="0.8"/>
//
// Frames      as an element `pose`: its values move the part within its parent.
// Parameters  x y z (m), roll pitch yaw (deg), all live. The physics writes those of a dynamic body; a value that is
//             set from outside puts the body there, at rest. With a belt also belt_speed (m/s).
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include <simvis/node.h>
#include "elements/dynamics/dynamic_scene.h"
#include "elements/pose_rows.h"

namespace simvis {

class BodyElement : public Element, public Stateful, private DynamicObject {
 public:
  /// Throws InputError: no physics, no part, and what body_rows.h says.
  explicit BodyElement(const ElementContext& context);
  ~BodyElement() override { dynamic_->remove(*this); }
  void update(ParameterView values) override;
  void adapt_parameters(std::vector<AttributeSpec>& live_rows) const override;
  bool moves_itself() const override { return desc_.kind == BodyKind::dynamic; }
  void advance(std::int64_t time_ns, std::span<double> values) override;
  void archive(StateArchive& state) override {
    state.finite(desc_.world_from_body, world_from_parent_, from_, to_);
    state(entered_, was_set_, written_);
  }

 private:
  std::size_t enter(DynamicsWorld& world, const glm::dmat4& world_from_point) override;
  void begin_steps(DynamicsWorld& world, const glm::dmat4& world_from_point) override;
  void before_step(DynamicsWorld& world, double share) override;
  DynamicParts parts() const override { return {.kind = desc_.kind, .mass = &desc_.mass, .shapes = desc_.shapes}; }
  std::optional<int> link_at(std::string_view insertion_point) const override {
    return desc_.kind == BodyKind::dynamic ? DynamicObject::link_at(insertion_point) : std::nullopt;
  }

  std::shared_ptr<DynamicScene> dynamic_;
  std::shared_ptr<Transform> transform_;
  BodyDesc desc_;                        // as it first entered
  std::optional<glm::dvec3> belt_axis_;  // unit length, in the frame of the part
  double belt_speed_m_s_ = 0;
  bool entered_ = false, was_set_ = false;
  glm::dmat4 world_from_parent_{1.0};          // of a dynamic body
  glm::dmat4 from_{1.0}, to_{1.0};             // of a kinematic body, in the steps of a frame
  std::array<double, kPoseValues> written_{};  // the values as update() got them last
};

}  // namespace simvis
