#include "elements/dynamics/vehicles/vehicle.h"

#include <algorithm>
#include <cmath>
#include <glm/trigonometric.hpp>
#include <limits>
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

constexpr AttributeSpec kSideSpeedRows[] = {
    wheel_speed("left", "speed of the left wheel or track, differential drive or tracks"),
    wheel_speed("right", "speed of the right wheel or track, differential drive or tracks"),
};
constexpr AttributeSpec kMecanumSpeedRows[] = {
    wheel_speed("front_left", "speed of this wheel, mecanum drive"),
    wheel_speed("front_right", "speed of this wheel, mecanum drive"),
    wheel_speed("rear_left", "speed of this wheel, mecanum drive"),
    wheel_speed("rear_right", "speed of this wheel, mecanum drive"),
};
constexpr AttributeSpec kOmniSpeedRows[] = {
    wheel_speed("wheel_1", "speed of the wheel at 60 degrees to the left of x, omni drive; positive turns to the left"),
    wheel_speed("wheel_2", "speed of the wheel behind, omni drive"),
    wheel_speed("wheel_3", "speed of the wheel at 60 degrees to the right of x, omni drive"),
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
    .summary = "The part at its insertion point drives on wheels or tracks, by their speeds.",
    .notes = "Needs an element physics before it in the scene. The part's frame has x forward and its origin on the "
             "floor; wheels are balls of the given radius, which roll and grip at one point as thin wheels do. "
             "Wheels with rollers and tracks have the speeds that are set, whatever torque this takes. What "
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
      row(&Wheels::drive, "drive",
          {{Wheels::Drive::differential, "differential"},
           {Wheels::Drive::ackermann, "ackermann"},
           {Wheels::Drive::mecanum, "mecanum"},
           {Wheels::Drive::omni, "omni"},
           {Wheels::Drive::tracked, "tracked"}},
          "differential: two wheels and a caster; ackermann: two driven rear wheels and two steered front wheels; "
          "mecanum: four wheels with rollers at 45 degrees; omni: three wheels on a circle with rollers across; "
          "tracked: two tracks"),
      AttributeTable(body_rows()),
      AttributeTable(surface_rows()),
      row(&Wheels::radius_m, "wheel_radius", "m", kLength, "radius of each wheel"),
      row(&Wheels::track_m, "track", "m", kLength,
          "distance of the wheels of one axle, or of the middles of both tracks; of an omni drive the diameter of the "
          "circle of its wheels"),
      row(&Wheels::wheelbase_m, "wheelbase", "m", kLength,
          "distance of the axles of an ackermann or mecanum drive, or length of the tracks on the floor")
          .only("for an ackermann or mecanum drive and tracks", &Wheels::has_wheelbase),
      row(&Wheels::width_m, "track_width", "m", kLength, "width of each track")
          .only("for a tracked drive", &Wheels::is_tracked),
      AttributeRows<Wheels>(join_tables({rows_of_links(kDrivenLinks)}))
          .only("for a differential or ackermann drive", &Wheels::has_motors),
      AttributeRows<Wheels>(join_tables({rows_of_links(kFrontLinks)}))
          .only("for an ackermann drive", &Wheels::is_ackermann),
      row(&Wheels::axle_m, "axle", "m", kPlace,
          "x of the driven axle in the part's frame; of a mecanum drive and tracks that of the rear end, of an omni "
          "drive of the middle of its circle"),
      row(&Wheels::caster_m, "caster", "m", kPlace,
          "x of the caster of a differential drive, from the axle; it slides without friction")
          .only("for a differential drive", &Wheels::is_differential),
      row(&Wheels::clearance_m, "clearance", "m", {.min = 0, .max = kMaxWheel_m},
          "height below which the part does not collide, so that its wheels carry it"),
      row(&Wheels::mass_kg, "wheel_mass", "kg", kAboveZero, "mass of each wheel or track"),
      row(&Wheels::friction, "wheel_friction", "", {.min = 0, .max = 1e3},
          "of a wheel or track and the floor, the product is the coefficient of friction"),
      row(&Wheels::max_torque_nm, "max_torque", "N m", kAboveZero, "largest torque of each driven wheel")
          .only("for a differential or ackermann drive", &Wheels::has_motors),
      AttributeTable(kPoseRows),
      AttributeRows<Wheels>(AttributeTable(kSideSpeedRows))
          .only("for a differential drive and tracks", &Wheels::has_sides),
      AttributeRows<Wheels>(AttributeTable(kAckermannSpeedRows)).only("for an ackermann drive", &Wheels::is_ackermann),
      AttributeRows<Wheels>(AttributeTable(kMecanumSpeedRows)).only("for a mecanum drive", &Wheels::is_mecanum),
      AttributeRows<Wheels>(AttributeTable(kOmniSpeedRows)).only("for an omni drive", &Wheels::is_omni)};
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
  switch (wheels_.drive) {
    case VehicleWheels::Drive::differential:
      add_differential();
      break;
    case VehicleWheels::Drive::ackermann:
      add_ackermann();
      break;
    case VehicleWheels::Drive::mecanum:
      add_surfaces(mecanum_wheels(wheels_.axle_m, wheels_.wheelbase_m, wheels_.track_m, wheels_.radius_m));
      break;
    case VehicleWheels::Drive::omni:
      add_surfaces(omni_wheels(wheels_.axle_m, wheels_.track_m / 2, wheels_.radius_m));
      break;
    case VehicleWheels::Drive::tracked:
      add_surfaces(tracks(wheels_.axle_m, wheels_.wheelbase_m, wheels_.track_m, wheels_.width_m, wheels_.radius_m));
      break;
  }
  show_wheels(context);
  transform_->name = name;
  context.scene.insert(context.command, transform_);
  dynamic_->add(*this);
}

VehicleElement::~VehicleElement() {
  for (const ShownJoint& each : shown_) {
    each.driver->value = nullptr;
    each.driver->speed = nullptr;
    each.driver->effort = nullptr;
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
      if (!shown.steers && joint->has_limits()) {
        fail_at(at, "joint " + in_quotes(word) + " has limits, expected one that turns without end");
      }
      const bool is_taken = std::ranges::find(shown_, joint->driver(), &ShownJoint::driver) != shown_.end();
      if (is_taken || joint->driver()->value) {
        fail_at(at, "joint " + in_quotes(word) + " is moved by another element, or named twice");
      }
      shown_.push_back({.driver = joint->driver(), .link = shown.link, .sign = along < 0 ? -1.0 : 1.0});
    }
  };
  std::ranges::for_each(kDrivenLinks, add);
  if (wheels_.is_ackermann()) std::ranges::for_each(kFrontLinks, add);
  for (const ShownJoint& each : shown_) {
    each.driver->value = [this, &each](std::int64_t time_ns) {
      dynamic_->advance(time_ns);
      return id ? shown_deg(each) : each.driver->current;
    };
    each.driver->speed = [this, &each]() -> std::optional<double> {
      if (!id) return std::nullopt;
      return dynamic_->is_running() ? each.sign * glm::degrees(dynamic_->world()->joint(*id, each.link).speed) : 0;
    };
    each.driver->effort = [this, &each] {
      return id ? each.sign * dynamic_->world()->joint(*id, each.link).effort
                : std::numeric_limits<double>::quiet_NaN();
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

void VehicleElement::add_surfaces(std::vector<VehicleSurface> surfaces) {
  surfaces_ = std::move(surfaces);
  int part = 0;
  for (const VehicleSurface& surface : surfaces_) {
    CollisionShape shape = surface.shape;
    desc_.mass = sum_of(desc_.mass, with_mass(mass_of({&shape, 1}, 1), wheels_.mass_kg));
    shape.surface = {.friction = wheels_.friction, .restitution = 0, .mask = desc_.surface.mask};
    shape.part = ++part;
    desc_.shapes.push_back(std::move(shape));
  }
}

void VehicleElement::adapt_parameters(std::vector<AttributeSpec>& live_rows) const {
  rows_of<VehicleWheels>().adapt(wheels_, live_rows);
}

void VehicleElement::update(ParameterView values) {
  const ParameterView place = values.first(kPoseValues);
  was_set_ = was_set_ || !std::ranges::equal(place, written_);
  std::ranges::copy(place, written_.begin());
  transform_->set_matrix(matrix_of_pose(place));
  for (std::size_t i = kPoseValues; i < values.size(); ++i) speeds_[i - kPoseValues] = glm::radians(values[i]);
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
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    world.move_surface({*id, static_cast<int>(i) + 1}, surfaces_[i].motion(speeds_[i] * wheels_.radius_m));
  }
  for (ShownJoint& each : shown_) {
    if (!std::exchange(each.driver->was_set, false)) continue;
    each.zero_deg += each.driver->current - shown_deg(each);
  }
}

void VehicleElement::before_step(DynamicsWorld& world, double /*share*/) {
  if (wheels_.has_motors()) drive_wheels(world);
}

void VehicleElement::drive_wheels(DynamicsWorld& world) const {
  const auto drive = [&](std::size_t wheel, double speed) {
    world.drive(*id, wheel, {JointDrive::Kind::speed, speed, wheels_.max_torque_nm});
  };
  if (wheels_.is_differential()) {
    drive(0, speeds_[0]);
    drive(1, speeds_[1]);
    return;
  }
  // All wheels turn about one point on the line of the rear axle: at 1 / curvature to the left.
  const double curvature_per_m = std::tan(speeds_[1]) / wheels_.wheelbase_m;
  std::size_t fork = 2;
  for (const double side : {1.0, -1.0}) {
    const double share = 1 - side * wheels_.track_m / 2 * curvature_per_m;
    drive(side > 0 ? 0 : 1, speeds_[0] * share);
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
  if (!wheels_.is_ackermann()) {
    std::vector<ParameterSetting> settings;
    double fastest = glm::radians(kMaxWheelSpeed_deg_s);
    const auto add = [&](std::string_view parameter, double speed_rad_s) {
      settings.push_back({name, std::string(parameter), speed_rad_s});
      fastest = std::max(fastest, std::abs(speed_rad_s));
    };
    for (const VehicleSurface& surface : surfaces_) add(surface.parameter, surface.speed_of(command) / radius);
    if (wheels_.is_differential()) add("left", (forward - turn * wheels_.track_m / 2) / radius);
    if (wheels_.is_differential()) add("right", (forward + turn * wheels_.track_m / 2) / radius);
    const double share = glm::radians(kMaxWheelSpeed_deg_s) / fastest;
    for (ParameterSetting& setting : settings) setting.value = wheel_deg_s(setting.value * share);
    return settings;
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
