// The element `body`: the part at which it stands becomes a rigid body.
//
//   <element type="body" name="BALL_BODY" insert_at="BALL" shape="sphere" mass="2" restitution="0.8"/>
//
// Frames      as an element `pose`: its values move the part within its parent.
// Parameters  x y z (m), roll pitch yaw (deg), all live. The physics writes those of a dynamic body; a value that is
//             set from outside puts the body there, at rest. With a belt also belt_speed (m/s).
#include <algorithm>
#include <array>
#include <iterator>
#include <memory>
#include <optional>
#include <vector>

#include <simvis/node.h>
#include "elements/dynamics/body_rows.h"
#include "elements/dynamics/dynamic_scene.h"
#include "elements/pose_rows.h"
#include "scenegraph/motion_path.h"

namespace simvis {
namespace {

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

constexpr double kMaxBodySpeed = 1e4;

constexpr AttributeSpec kBodyKindRow = {
    .name = "kind",
    .kind = AttributeKind::choice,
    .default_value = "dynamic",
    .text = "dynamic: forces move it; static: nothing does; kinematic: it pushes others and follows its elements",
    .choices = "dynamic static kinematic"};
constexpr AttributeSpec kBodyMotionRows[] = {
    {.name = "linear_damping", .default_value = "0", .unit = "1/s", .text = "rate at which its speed fades", .min = 0},
    {.name = "angular_damping", .default_value = "0", .unit = "1/s", .text = "rate at which its spin fades", .min = 0},
    {.name = "velocity",
     .kind = AttributeKind::vector,
     .default_value = "0 0 0",
     .unit = "m/s",
     .text = "of the centre of mass at the start, along the axes of the world",
     .min = -kMaxBodySpeed,
     .max = kMaxBodySpeed},
    {.name = "angular_velocity",
     .kind = AttributeKind::vector,
     .default_value = "0 0 0",
     .unit = "deg/s",
     .text = "at the start, about the axes of the world",
     .min = -1e6,
     .max = 1e6}};

constexpr std::string_view kBeltName = "belt", kBeltSpeedName = "belt_speed";
constexpr AttributeSpec kBeltRow = {
    .name = kBeltName,
    .kind = AttributeKind::vector,
    .text =
        "its surface is a belt that carries what lies on top along this direction of the part's frame, across z; "
        "default: it is none"};
constexpr AttributeSpec kBeltSpeedRow = {.name = kBeltSpeedName,
                                         .default_value = "0",
                                         .unit = "m/s",
                                         .text = "speed of the belt",
                                         .min = -kMaxBodySpeed,
                                         .max = kMaxBodySpeed,
                                         .live = true};

AttributeTable body_attributes() {
  static const AttributeTable table = join_tables({{kBodyKindRow},
                                                   body_rows(),
                                                   surface_rows(),
                                                   {std::begin(kBodyMotionRows), std::end(kBodyMotionRows)},
                                                   {kBeltRow},
                                                   pose_rows(),
                                                   {kBeltSpeedRow}});
  return table;
}

constexpr std::string_view kOfDynamicBodies[] = {"mass", "density", "inertia", "center"};

const ElementRegistration kBodyRegistration({
    .name = "body",
    .summary = "Makes the part at its insertion point a rigid body; what is inserted there later moves along.",
    .notes = "Needs an element physics before it in the scene. x, y, z, roll, pitch and yaw move the part as those of "
             "an element pose do: the physics writes them for a dynamic body, and a value that is set puts the body "
             "there, at rest. Only the part's own surface collides.",
    .attributes = body_attributes(),
    .create = create_element<BodyElement>,
});

glm::dvec3 to_dvec3(const double (&v)[3]) { return {v[0], v[1], v[2]}; }

BodyKind read_kind(const AttributeValues& attributes) {
  const std::string& kind = attributes.choice("kind");
  if (kind == "static") return BodyKind::fixed;
  return kind == "kinematic" ? BodyKind::kinematic : BodyKind::dynamic;
}

// Across which the belt turns, of unit length.
std::optional<glm::dvec3> read_belt_axis(const ElementContext& context) {
  const AttributeValues& attributes = context.attributes;
  if (!attributes.is_set(kBeltName)) {
    const CommandAttribute* const speed = context.command.find(kBeltSpeedName);
    if (speed == nullptr) return std::nullopt;
    fail_at(speed->where,
            "attribute " + in_quotes(kBeltSpeedName) + " is allowed only with the direction " + in_quotes(kBeltName));
  }
  if (attributes.vector(kBeltName)[2] != 0) {
    fail_at(attributes.where(kBeltName),
            "attribute " + in_quotes(kBeltName) + " is not allowed, expected a direction across z, such as 1 0 0");
  }
  return glm::cross(glm::dvec3(0, 0, 1), unit_axis(context, kBeltName));
}

BodyDesc read_body(const ElementContext& context) {
  const AttributeValues& attributes = context.attributes;
  BodyDesc body{.kind = read_kind(attributes), .surface = read_surface(attributes)};
  BodyShapes shapes = read_shapes(context, body.kind == BodyKind::fixed ? "mesh" : "hull");
  if (body.kind == BodyKind::dynamic) body.mass = read_mass(context, shapes);
  body.shapes = std::move(shapes.collision);
  body.linear_damping_per_s = attributes.number("linear_damping");
  body.angular_damping_per_s = attributes.number("angular_damping");
  body.velocity_m_s = to_dvec3(attributes.vector("velocity"));
  body.angular_velocity_rad_s = glm::radians(to_dvec3(attributes.vector("angular_velocity")));
  if (body.kind == BodyKind::dynamic) return body;
  for (const std::string_view name : kOfDynamicBodies) {
    if (!attributes.is_set(name)) continue;
    fail_at(attributes.where(name), "attribute " + in_quotes(name) + " is not allowed for a " +
                                        attributes.choice("kind") + " body, expected it on a dynamic one");
  }
  return body;
}

}  // namespace

BodyElement::BodyElement(const ElementContext& context)
    : dynamic_(find_dynamic_scene(context)), transform_(std::make_shared<Transform>()), desc_(read_body(context)) {
  belt_axis_ = read_belt_axis(context);
  name = context.command.require("name").value;
  point = context.command.require("insert_at").value;
  where = context.command.where;
  stands = desc_.kind == BodyKind::fixed;
  follows_scene = desc_.kind == BodyKind::kinematic;
  transform_->name = name;
  context.scene.insert(context.command, transform_);
  dynamic_->add(*this);
}

void BodyElement::update(ParameterView values) {
  const ParameterView place = values.first(kPoseValues);
  was_set_ = was_set_ || !std::ranges::equal(place, written_);
  std::ranges::copy(place, written_.begin());
  transform_->set_matrix(matrix_of_pose(place));
  if (belt_axis_) belt_speed_m_s_ = values[kPoseValues];
}

void BodyElement::adapt_parameters(std::vector<AttributeSpec>& live_rows) const {
  if (!belt_axis_) live_rows.pop_back();  // the speed of the belt
}

std::size_t BodyElement::enter(DynamicsWorld& world, const glm::dmat4& world_from_point) {
  if (!entered_) {
    desc_.world_from_body = world_from_point;
    world_from_parent_ = world_from_point * rigid_inverse(transform_->matrix());
    entered_ = true;
  }
  was_set_ = false;
  from_ = to_ = moves_itself() ? desc_.world_from_body : world_from_point;
  BodyDesc desc = desc_;
  desc.world_from_body = to_;
  return world.add_body(desc);
}

void BodyElement::begin_steps(DynamicsWorld& world, const glm::dmat4& world_from_point) {
  if (desc_.kind == BodyKind::kinematic) {
    from_ = to_;
    to_ = world_from_point;
  } else if (was_set_) {
    world.move(*id, world_from_parent_ * transform_->matrix());
  }
  was_set_ = false;
  if (belt_axis_) world.move_surface({*id, 0}, {.belt_m_s = belt_speed_m_s_ * *belt_axis_});
}

void BodyElement::before_step(DynamicsWorld& world, double share) {
  if (desc_.kind == BodyKind::kinematic) world.move(*id, pose_between(from_, to_, share));
}

void BodyElement::advance(std::int64_t time_ns, std::span<double> values) {
  dynamic_->advance(time_ns);
  if (!id || was_set_) return;
  write_pose(rigid_inverse(world_from_parent_) * dynamic_->world()->state(*id).world_from_body, values);
  std::ranges::copy(values.first(kPoseValues), written_.begin());
}

}  // namespace simvis
