#include "elements/dynamics/vehicle.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/trigonometric.hpp>
#include <iterator>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "elements/dynamics/body_rows.h"
#include "elements/dynamics/world/mass.h"
#include "engine/base/words.h"

namespace simvis {
namespace {

constexpr double kMaxWheel_m = 1e3, kMaxWheelSpeed_deg_s = 1e5, kMaxSteer_deg = 60;
// A steered wheel turns to its angle within some tenths of a second.
constexpr double kSteerGain_per_s = 20, kMaxSteer_rad_s = 5;

constexpr AttributeSpec wheel_speed(std::string_view name, std::string_view text) {
  return {.name = name,
          .default_value = "0",
          .unit = "deg/s",
          .text = text,
          .min = -kMaxWheelSpeed_deg_s,
          .max = kMaxWheelSpeed_deg_s,
          .live = true};
}

constexpr AttributeSpec kDifferentialSpeedRows[] = {
    wheel_speed("left", "speed of the left wheel, differential drive"),
    wheel_speed("right", "speed of the right wheel, differential drive"),
};

constexpr AttributeSpec kAckermannSpeedRows[] = {
    wheel_speed("speed", "mean speed of the rear wheels, ackermann drive"),
    {.name = "steer",
     .default_value = "0",
     .unit = "deg",
     .text = "angle of a wheel in the middle of the front axle, ackermann drive; positive is to the left",
     .min = -kMaxSteer_deg,
     .max = kMaxSteer_deg,
     .live = true},
};

// The links of ArticulationDesc that joints of the file show, see add_differential() and add_ackermann().
struct ShownLink {
  AttributeSpec row;
  std::size_t link;
  bool steers = false;
};
constexpr AttributeSpec joints_row(std::string_view name, std::string_view text) {
  return {.name = name, .kind = AttributeKind::text, .text = text};
}
constexpr ShownLink kDrivenLinks[] = {
    {joints_row("left_joints", "elements joint that turn as the left driven wheel, separated by spaces"), 0},
    {joints_row("right_joints", "elements joint that turn as the right driven wheel, separated by spaces"), 1}};
constexpr ShownLink kFrontLinks[] = {
    {joints_row("front_left_joints", "elements joint that turn as the left front wheel"), 3},
    {joints_row("front_right_joints", "elements joint that turn as the right front wheel"), 5},
    {joints_row("steer_left_joints", "elements joint that steer as the left front wheel"), 2, true},
    {joints_row("steer_right_joints", "elements joint that steer as the right front wheel"), 4, true}};

std::vector<AttributeSpec> rows_of_links(std::span<const ShownLink> links) {
  std::vector<AttributeSpec> rows;
  for (const ShownLink& each : links) rows.push_back(each.row);
  return rows;
}

const ElementRegistration kVehicleRegistration({
    .name = "vehicle",
    .summary = "The part at its insertion point drives on wheels, by their speeds.",
    .notes = "Needs an element physics before it in the scene. The part's frame has x forward and its origin on the "
             "floor; wheels are balls of the given radius, which roll and grip at one point as thin wheels do. What "
             "the vehicle runs into pushes back. mass is that of the part without the wheels.",
    .attributes = rows_of<VehicleWheels>().table(),
    .create = create_element<VehicleElement>,
});

double wheel_deg_s(double speed_rad_s) {
  return std::clamp(glm::degrees(speed_rad_s), -kMaxWheelSpeed_deg_s, kMaxWheelSpeed_deg_s);
}

}  // namespace

AttributeRows<VehicleWheels> VehicleWheels::rows() {
  using Wheels = VehicleWheels;
  constexpr AttributeLimits kLength{.min = 0, .max = kMaxWheel_m, .open_min = true},
      kPlace{.min = -kMaxWheel_m, .max = kMaxWheel_m};
  return {
      row(&Wheels::ackermann, "drive", {{false, "differential"}, {true, "ackermann"}},
          "differential: two wheels and a caster; ackermann: two driven rear wheels and two steered front wheels"),
      AttributeTable(body_rows()),
      AttributeTable(surface_rows()),
      row(&Wheels::radius_m, "wheel_radius", "m", kLength, "radius of each wheel"),
      row(&Wheels::track_m, "track", "m", kLength, "distance of the wheels of one axle"),
      row(&Wheels::wheelbase_m, "wheelbase", "m", kLength, "distance of the axles of an ackermann drive")
          .only("for an ackermann drive", &Wheels::ackermann),
      AttributeTable(join_tables({rows_of_links(kDrivenLinks)})),
      AttributeRows<Wheels>(join_tables({rows_of_links(kFrontLinks)}))
          .only("for an ackermann drive", &Wheels::ackermann),
      row(&Wheels::axle_m, "axle", "m", kPlace, "x of the driven axle in the part's frame"),
      row(&Wheels::caster_m, "caster", "m", kPlace,
          "x of the caster of a differential drive, from the axle; it slides without friction")
          .only("for a differential drive", std::not_fn(&Wheels::ackermann)),
      row(&Wheels::clearance_m, "clearance", "m", {.min = 0, .max = kMaxWheel_m},
          "height below which the part does not collide, so that its wheels carry it"),
      row(&Wheels::mass_kg, "wheel_mass", "kg", kAboveZero, "mass of each wheel"),
      row(&Wheels::friction, "wheel_friction", "", {.min = 0, .max = 1e3},
          "of a wheel and the floor, the product is the coefficient of friction"),
      row(&Wheels::max_torque_nm, "max_torque", "N m", kAboveZero, "largest torque of each driven wheel"),
      AttributeTable(kPoseRows),
      AttributeRows<Wheels>(AttributeTable(kDifferentialSpeedRows))
          .only("for a differential drive", std::not_fn(&Wheels::ackermann)),
      AttributeRows<Wheels>(AttributeTable(kAckermannSpeedRows)).only("for an ackermann drive", &Wheels::ackermann)};
}

VehicleElement::VehicleElement(const ElementContext& context)
    : dynamic_(find_dynamic_scene(context)), transform_(std::make_shared<Transform>()) {
  const AttributeValues& attributes = context.attributes;
  name = context.command.require("name").value;
  point = context.command.require("insert_at").value;
  where = context.command.where;
  wheels_ = rows_of<VehicleWheels>().read(context.command, attributes);
  desc_.fixed_base = false;
  BodyShapes shapes = read_shapes(context, "hull", wheels_.clearance_m);
  desc_.mass = read_mass(context, shapes);
  desc_.shapes = std::move(shapes.collision);
  desc_.surface = read_surface(attributes);
  wheels_.ackermann ? add_ackermann() : add_differential();
  show_wheels(context);
  transform_->name = name;
  context.scene.insert(context.command, transform_);
  dynamic_->add(*this);
}

VehicleElement::~VehicleElement() {
  for (const ShownJoint& each : shown_) {
    each.driver->value = nullptr;
    each.driver->speed = nullptr;
  }
  dynamic_->remove(*this);
}

// The axes are compared as the scene stands now: wheels turn about y of the part, forks about z.
void VehicleElement::show_wheels(const ElementContext& context) {
  constexpr double kAlongAxis = 0.999;  // cosine: 2.5 degrees for the camber and toe of wheels
  const std::optional<glm::dmat4> world_from_part = context.scene.world_from_point(point);
  const auto add = [&](const ShownLink& shown) {
    if (!context.attributes.is_set(shown.row.name)) return;
    const Location at = context.attributes.where(shown.row.name);
    for (const std::string_view word : words_of(context.attributes.text(shown.row.name))) {
      const auto* const joint = dynamic_cast<const JointElement*>(context.find_element(word));
      if (joint == nullptr) fail_at(at, "there is no element " + in_quotes(word) + " of type joint");
      const std::optional<glm::dmat4> world_from_joint = context.scene.world_from_point(joint->point());
      if (!world_from_part || !world_from_joint)
        fail_at(at, "joint " + in_quotes(word) + " stands in a part that is off");
      const glm::dvec3 axis = glm::dmat3(rigid_inverse(*world_from_part) * *world_from_joint) * joint->motion().axis;
      const double along = shown.steers ? axis.z : axis.y;
      if (!joint->motion().revolute || std::abs(along) < kAlongAxis) {
        fail_at(at, "joint " + in_quotes(word) + " does not turn about " + (shown.steers ? "z" : "y") +
                        " of the part " + in_quotes(point) + ", expected one that turns as " +
                        (shown.steers ? "a steered wheel does" : "a wheel does"));
      }
      if (joint->driver()->value) fail_at(at, "joint " + in_quotes(word) + " is moved by another element");
      shown_.push_back({.driver = joint->driver(), .link = shown.link, .sign = along < 0 ? -1.0 : 1.0});
      joint->driver()->value = [](std::int64_t) { return 0.0; };  // it is taken; see below
    }
  };
  std::ranges::for_each(kDrivenLinks, add);
  if (wheels_.ackermann) std::ranges::for_each(kFrontLinks, add);
  for (const ShownJoint& each : shown_) {
    each.driver->value = [this, &each](std::int64_t time_ns) {
      dynamic_->advance(time_ns);
      return id ? shown_deg(each) : each.driver->current;
    };
    each.driver->speed = [this, &each]() -> std::optional<double> {
      if (!id) return std::nullopt;
      return dynamic_->is_running() ? each.sign * glm::degrees(dynamic_->world()->joint(*id, each.link).speed) : 0;
    };
  }
}

double VehicleElement::shown_deg(const ShownJoint& joint) const {
  return joint.zero_deg + joint.sign * glm::degrees(dynamic_->world()->joint(*id, joint.link).position);
}

void VehicleElement::add_wheel(int parent, const glm::dvec3& at, bool spins, double friction) {
  LinkDesc wheel{.parent = parent, .joint = spins ? JointKind::revolute : JointKind::fixed, .axis = {0, 1, 0}};
  wheel.parent_from_joint[3] = glm::dvec4(at, 1);
  wheel.shapes = {{.kind = CollisionKind::sphere, .half_m = glm::dvec3(wheels_.radius_m)}};
  wheel.mass = with_mass(mass_of(wheel.shapes, 1), wheels_.mass_kg);
  wheel.surface = {.friction = friction, .restitution = 0, .mask = desc_.surface.mask};
  desc_.links.push_back(std::move(wheel));
}

void VehicleElement::add_steering(double y) {
  LinkDesc fork{.parent = -1, .joint = JointKind::revolute, .axis = {0, 0, 1}};
  fork.parent_from_joint[3] = glm::dvec4(wheels_.axle_m + wheels_.wheelbase_m, y, wheels_.radius_m, 1);
  const CollisionShape ball{.kind = CollisionKind::sphere, .half_m = glm::dvec3(wheels_.radius_m / 2)};
  fork.mass = with_mass(mass_of({&ball, 1}, 1), wheels_.mass_kg);
  desc_.links.push_back(std::move(fork));
  add_wheel(static_cast<int>(desc_.links.size()) - 1, {0, 0, 0}, true, wheels_.friction);
}

void VehicleElement::add_differential() {
  for (const double side : {1.0, -1.0}) {
    add_wheel(-1, {wheels_.axle_m, side * wheels_.track_m / 2, wheels_.radius_m}, true, wheels_.friction);
  }
  add_wheel(-1, {wheels_.axle_m + wheels_.caster_m, 0, wheels_.radius_m}, false, 0);
}

// Links: rear left, rear right, front left fork and wheel, front right fork and wheel.
void VehicleElement::add_ackermann() {
  for (const double side : {1.0, -1.0}) {
    add_wheel(-1, {wheels_.axle_m, side * wheels_.track_m / 2, wheels_.radius_m}, true, wheels_.friction);
  }
  for (const double side : {1.0, -1.0}) add_steering(side * wheels_.track_m / 2);
}

void VehicleElement::adapt_parameters(std::vector<AttributeSpec>& live_rows) const {
  rows_of<VehicleWheels>().adapt(wheels_, live_rows);
}

void VehicleElement::update(ParameterView values) {
  const ParameterView place = values.first(kPoseValues);
  was_set_ = was_set_ || !std::ranges::equal(place, written_);
  std::ranges::copy(place, written_.begin());
  transform_->set_matrix(matrix_of_pose(place));
  first_ = glm::radians(values[kPoseValues]);
  second_ = glm::radians(values[kPoseValues + 1]);
}

std::size_t VehicleElement::enter(DynamicsWorld& world, const glm::dmat4& world_from_point) {
  if (!entered_) {
    world_from_parent_ = world_from_point * rigid_inverse(transform_->matrix());
    desc_.world_from_base = world_from_point;
    for (ShownJoint& each : shown_) each.first_deg = each.driver->current;
    entered_ = true;
  }
  was_set_ = false;
  for (ShownJoint& each : shown_) {
    each.zero_deg = each.first_deg;
    each.driver->was_set = false;
  }
  return world.add_articulation(desc_);
}

void VehicleElement::begin_steps(DynamicsWorld& world, const glm::dmat4& /*world_from_point*/) {
  if (was_set_) world.move(*id, world_from_parent_ * transform_->matrix());
  was_set_ = false;
  for (ShownJoint& each : shown_) {
    if (!std::exchange(each.driver->was_set, false)) continue;
    each.zero_deg += each.driver->current - shown_deg(each);
  }
}

void VehicleElement::before_step(DynamicsWorld& world, double /*share*/) {
  const auto drive = [&](std::size_t wheel, double speed) {
    world.drive(*id, wheel, {JointDrive::Kind::speed, speed, wheels_.max_torque_nm});
  };
  if (!wheels_.ackermann) {
    drive(0, first_);
    drive(1, second_);
    return;
  }
  // All wheels turn about one point on the line of the rear axle: at 1 / curvature to the left.
  const double curvature_per_m = std::tan(second_) / wheels_.wheelbase_m;
  std::size_t fork = 2;
  for (const double side : {1.0, -1.0}) {
    const double share = 1 - side * wheels_.track_m / 2 * curvature_per_m;
    drive(side > 0 ? 0 : 1, first_ * share);
    const double angle = std::atan2(wheels_.wheelbase_m * curvature_per_m, share);
    world.drive(*id, fork,
                {.kind = JointDrive::Kind::position,
                 .target = angle,
                 .max_effort = wheels_.max_torque_nm,
                 .gain_per_s = kSteerGain_per_s,
                 .max_speed = kMaxSteer_rad_s});
    fork += 2;
  }
}

// An ackermann drive that stands cannot turn, and its wheels keep their angle.
std::vector<ParameterSetting> VehicleElement::settings_of(const VelocityCommand& command) const {
  const double forward = command.forward_m_s, turn = command.turn_rad_s, radius = wheels_.radius_m;
  const double max_rad_s = glm::radians(kMaxWheelSpeed_deg_s);
  if (!wheels_.ackermann) {
    const double left = (forward - turn * wheels_.track_m / 2) / radius;
    const double right = (forward + turn * wheels_.track_m / 2) / radius;
    const double share = max_rad_s / std::max({std::abs(left), std::abs(right), max_rad_s});
    return {{name, "left", wheel_deg_s(left * share)}, {name, "right", wheel_deg_s(right * share)}};
  }
  std::vector<ParameterSetting> settings{{name, "speed", wheel_deg_s(forward / radius)}};
  if (forward == 0) return settings;
  const double steer_deg = glm::degrees(std::atan(wheels_.wheelbase_m * turn / forward));
  settings.push_back({name, "steer", std::clamp(steer_deg, -kMaxSteer_deg, kMaxSteer_deg)});
  return settings;
}

void VehicleElement::advance(std::int64_t time_ns, std::span<double> values) {
  dynamic_->advance(time_ns);
  if (!id || was_set_) return;
  write_pose(rigid_inverse(world_from_parent_) * dynamic_->world()->state(*id).world_from_body, values);
  std::ranges::copy(values.first(kPoseValues), written_.begin());
}

}  // namespace simvis
