#include "simvis/ros/frame_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <memory>
#include <utility>

#include <simvis/error.h>
#include <simvis/measurement.h>
#include <simvis/pose.h>
#include "elements/animation.h"
#include "elements/described_robot.h"
#include "elements/frame.h"
#include "exchange/messages/detections.h"
#include "exchange/messages/from_pose.h"
#include "scenegraph/graph_walk.h"
#include "scenegraph/language/attribute_place.h"
#include "simvis/mount_frame.h"

namespace simvis {
namespace {

constexpr std::string_view kRoot = "ROOT", kFrame = "frame", kOdomFrame = "odom_frame", kTf = "tf";

std::string attribute_or(const BuiltSensor& sensor, std::string_view name, std::string_view otherwise) {
  const CommandAttribute* const found = sensor.command.find(name);
  return found == nullptr ? std::string(otherwise) : found->value;
}

bool is_odometry(const BuiltSensor& sensor) { return sensor.type == "odometry"; }
bool gives_transform(const BuiltSensor& sensor) {
  return is_odometry(sensor) && attribute_or(sensor, kTf, "none") != "none";
}
bool gives_map(const BuiltSensor& sensor) { return is_odometry(sensor) && attribute_or(sensor, kTf, "none") == "map"; }

// The nodes with which elements move what follows.
std::set<const Node*> find_movers(const BuiltScene& scene) {
  std::set<const Node*> movers;
  for (std::size_t i = 0; i < scene.elements.size(); ++i) {
    if (scene.elements[i] == nullptr) continue;
    const NodePtr node = scene.scene.find_node(scene.parameters.elements()[i].name);
    if (node != nullptr && node->kind() == NodeKind::transform) movers.insert(node.get());
    const auto* const animation = dynamic_cast<const AnimationElement*>(scene.elements[i].get());
    if (animation == nullptr) continue;
    const std::vector<const Node*> driven = animation->driven();
    movers.insert(driven.begin(), driven.end());
  }
  return movers;
}

// Null: the node stands nowhere below the root.
const FrameChain* chain_of(const Node& node, const FrameChains& chains) {
  const auto found = chains.find(&node);
  return found == chains.end() ? nullptr : &found->second;
}

// As chain_of() of the point's node; of ROOT and of no point, the empty chain.
const FrameChain* chain_of(const std::string& point, const BuiltScene& scene, const FrameChains& chains) {
  static const FrameChain nothing;
  return point.empty() || point == kRoot ? &nothing : chain_of(scene.scene.point_node(point), chains);
}

// A sensor without an offset stands at its point, within the rounding of two poses in the world, which is some 1e-12
// within kilometres of its origin. What it measures then holds for the point to the last bit.
bool is_identity(const glm::dmat4& matrix) {
  constexpr double kPlaceRounding = 1e-9;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) {
      if (!(std::abs(matrix[column][row] - (column == row ? 1 : 0)) <= kPlaceRounding)) return false;
    }
  }
  return true;
}

// The names of the views of a sensor whose images or detections have an optical frame.
std::vector<std::string> views_of(const BuiltSensor& sensor) {
  std::vector<std::string> views;
  const Measurement measurement = sensor.sensor->measurement();
  const bool any = has_content(sensor.outputs, ImageContent::color) ||
                   has_content(sensor.outputs, ImageContent::depth) ||
                   has_content(sensor.outputs, ImageContent::counts) || ros::has_boxes(measurement.arrays);
  if (!any || measurement.calibrations == nullptr) return views;
  for (const Calibration& each : *measurement.calibrations) views.push_back(each.view);
  return views;
}

// Where the scene names each insertion point that has a frame: an element `frame`, else a robot's description, else the
// first sensor there.
std::map<std::string, Location> places_of_points(const BuiltScene& scene) {
  std::map<std::string, Location> places;
  for (const BuiltSensor& sensor : scene.sensors) {
    places.emplace(insertion_point(sensor), place_of(sensor.command, "insert_at"));
  }
  for (const std::unique_ptr<Element>& element : scene.elements) {
    const auto* const description = dynamic_cast<const DescribedRobot*>(element.get());
    if (description == nullptr) continue;
    for (const std::string& point : description->points()) places.insert_or_assign(point, description->where());
  }
  for (const std::unique_ptr<Element>& element : scene.elements) {
    const auto* const frame = dynamic_cast<const FrameElement*>(element.get());
    if (frame != nullptr) places.insert_or_assign(frame->point(), frame->where());
  }
  return places;
}

// The pose of an odometry in its own frame, as it has measured it.
glm::dmat4 measured_pose(const Reading& reading) {
  const auto value = [&](std::string_view column) { return reading.find(column).value_or(0); };
  glm::dmat4 pose = glm::mat4_cast(glm::dquat(value("qw"), value("qx"), value("qy"), value("qz")));
  pose[3] = glm::dvec4(value("x_m"), value("y_m"), value("z_m"), 1);
  return pose;
}

}  // namespace

std::size_t count_changes(const BuiltScene& scene) { return scene.parameters.changes().size() + scene.next_sensor_id; }

std::string optical_frame(const std::string& sensor_frame, const std::string& view) {
  return sensor_frame + (view.empty() ? "" : "_" + view) + "_optical";
}

std::string insertion_point(const BuiltSensor& sensor) { return attribute_or(sensor, "insert_at", kRoot); }
std::string odometry_frame(const BuiltSensor& sensor) { return attribute_or(sensor, kOdomFrame, "odom"); }

void FrameTree::update(const BuiltScene& scene, std::span<const PlacedSensor> sensors) {
  follow(scene);
  transforms_.clear();
  place_points(scene);
  std::set<std::string> odometries;  // the odometry sensors that are on and give a transform
  for (const PlacedSensor& sensor : sensors) {
    if (!gives_transform(sensor.sensor)) continue;
    odometries.insert(sensor.sensor.name);
    add_odometry(sensor);
  }
  for (const std::string& name : order_) {
    const Point& point = points_.at(name);
    if (!odometries.contains(point.odometry)) add_point(name, point);
  }
  for (const PlacedSensor& sensor : sensors) add_sensor(sensor);
}

void FrameTree::follow(const BuiltScene& scene) {
  const std::size_t changes = count_changes(scene);
  if (changes_ == changes) return;
  world_ = ros::kWorldFrame;
  named_.clear();
  for (const std::unique_ptr<Element>& element : scene.elements) {
    const auto* const frame = dynamic_cast<const FrameElement*>(element.get());
    if (frame == nullptr) continue;
    if (frame->point() == kRoot) world_ = frame->frame();
    if (!named_.emplace(frame->point(), frame->frame()).second) {
      fail_at(frame->where(),
              "the insertion point " + in_quotes(frame->point()) + " has two elements of type \"frame\", expected one");
    }
  }
  find_points(scene);
  find_odometries(scene);
  check_names(scene);
  changes_ = changes;
}

void FrameTree::find_points(const BuiltScene& scene) {
  collect_points(scene);
  std::set<const Node*> wanted;
  for (const auto& [point, known] : points_) wanted.insert(&scene.scene.point_node(point));
  for (const BuiltSensor& sensor : scene.sensors) wanted.insert(sensor.mount.get());
  const FrameChains chains = find_chains(*scene.scene.root(), wanted);
  const std::set<const Node*> movers = find_movers(scene);
  find_parents(scene, chains, movers);
  order_points(scene, chains);
  find_moving_sensors(scene, chains, movers);
}

void FrameTree::collect_points(const BuiltScene& scene) {
  points_.clear();
  for (const auto& [point, frame] : named_) points_[point];
  for (const BuiltSensor& sensor : scene.sensors) points_[insertion_point(sensor)];
  for (const std::unique_ptr<Element>& element : scene.elements) {
    const auto* const description = dynamic_cast<const DescribedRobot*>(element.get());
    if (description == nullptr) continue;
    for (const std::string& point : description->points()) points_[point];
  }
  points_.erase(std::string(kRoot));
}

void FrameTree::find_parents(const BuiltScene& scene, const FrameChains& chains, const std::set<const Node*>& movers) {
  // The group right around a point has what stands there.
  std::map<const Node*, std::string> point_of_group;
  for (const auto& [point, known] : points_) {
    const FrameChain* const chain = chain_of(point, scene, chains);
    if (chain != nullptr) point_of_group[chain->groups.back()] = point;
  }
  for (auto& [point, known] : points_) {
    const FrameChain* const chain = chain_of(point, scene, chains);
    known.moves = true;
    if (chain == nullptr) continue;
    for (std::size_t i = chain->groups.size() - 1; i-- > 0 && known.parent.empty();) {
      const auto around = point_of_group.find(chain->groups[i]);
      if (around != point_of_group.end()) known.parent = around->second;
    }
    known.moves = stands_between(movers, *chain_of(known.parent, scene, chains), *chain);
  }
}

void FrameTree::order_points(const BuiltScene& scene, const FrameChains& chains) {
  std::vector<std::pair<std::size_t, std::string>> by_depth;
  for (const auto& [point, known] : points_) {
    const FrameChain* const chain = chain_of(point, scene, chains);
    by_depth.emplace_back(chain == nullptr ? 0 : chain->groups.size(), point);
  }
  std::ranges::sort(by_depth);
  order_.clear();
  for (auto& [depth, point] : by_depth) order_.push_back(std::move(point));
}

void FrameTree::find_moving_sensors(const BuiltScene& scene, const FrameChains& chains,
                                    const std::set<const Node*>& movers) {
  moving_sensors_.clear();
  for (const BuiltSensor& sensor : scene.sensors) {
    const FrameChain* const at = chain_of(insertion_point(sensor), scene, chains);
    const FrameChain* const chain = chain_of(*sensor.mount, chains);
    if (at == nullptr || chain == nullptr || stands_between(movers, *at, *chain)) moving_sensors_.insert(sensor.name);
  }
}

void FrameTree::find_odometries(const BuiltScene& scene) {
  for (const BuiltSensor& sensor : scene.sensors) {
    if (!gives_transform(sensor)) continue;
    const auto point = points_.find(insertion_point(sensor));
    if (point == points_.end()) {
      fail_at(
          place_of(sensor.command, kTf),
          "sensor " + in_quotes(sensor.name) + ": attribute \"tf\" is not allowed at ROOT, expected a part that moves");
    }
    if (!point->second.odometry.empty()) {
      fail_at(place_of(sensor.command, kTf), "sensors " + in_quotes(point->second.odometry) + " and " +
                                                 in_quotes(sensor.name) + " both give the transform of the frame " +
                                                 in_quotes(of_point(point->first)) +
                                                 ", expected \"tf\" of one of them");
    }
    point->second.odometry = sensor.name;
  }
}

void FrameTree::check_names(const BuiltScene& scene) const {
  std::map<std::string, std::string> user_of{{world_, "the world"}};
  const auto add = [&](const std::string& frame, const std::string& user, const Location& where) {
    const auto [known, is_new] = user_of.emplace(frame, user);
    if (is_new) return;
    fail_at(where, known->second + " and " + user + " would have the same frame " + in_quotes(frame) +
                       ", expected frames that differ");
  };
  const std::map<std::string, Location> places = places_of_points(scene);
  for (const auto& [point, known] : points_) {
    add(of_point(point), "the insertion point " + in_quotes(point), places.at(point));
  }
  for (const BuiltSensor& sensor : scene.sensors) {
    if (!gives_transform(sensor)) continue;
    add(odometry_frame(sensor), "the odometry " + in_quotes(sensor.name), place_of(sensor.command, kOdomFrame));
  }
  for (const BuiltSensor& sensor : scene.sensors) {
    const Location& where = place_of(sensor.command, kFrame);
    if (!shares_frame(sensor)) add(of_sensor(sensor), "the sensor " + in_quotes(sensor.name), where);
    for (const std::string& view : views_of(sensor)) {
      add(optical_frame(of_sensor(sensor), view), "a view of the sensor " + in_quotes(sensor.name), where);
    }
  }
}

bool FrameTree::shares_frame(const BuiltSensor& sensor) const {
  const CommandAttribute* const frame = sensor.command.find(kFrame);
  const std::string point = insertion_point(sensor);
  if (frame == nullptr || point == kRoot || frame->value != of_point(point)) return false;
  const auto is_given = [&](const char* name) { return sensor.command.find(name) != nullptr; };
  return !std::ranges::any_of(std::array{"pose_offset", "quaternion", "look_at"}, is_given) &&
         !moving_sensors_.contains(sensor.name);
}

std::string FrameTree::of_point(const std::string& point) const {
  if (point == kRoot) return world_;
  const auto named = named_.find(point);
  if (named != named_.end()) return named->second;
  return point == world_ ? point + "_body" : point;
}

std::string FrameTree::of_sensor(const BuiltSensor& sensor) const {
  if (const CommandAttribute* const frame = sensor.command.find(kFrame)) return frame->value;
  const auto is_it = [&](const auto& named) { return named.second == sensor.name; };
  const bool taken = sensor.name == world_ || points_.contains(sensor.name) || std::ranges::any_of(named_, is_it);
  return taken ? sensor.name + "_sensor" : sensor.name;
}

void FrameTree::place_points(const BuiltScene& scene) {
  world_from_point_.clear();
  std::map<const Node*, const std::string*> wanted;
  for (const auto& [point, known] : points_) wanted.emplace(&scene.scene.point_node(point), &point);
  if (wanted.empty()) return;
  walk_graph(*scene.scene.root(), {.visit = [&](const Node& node, const WalkState& state) {
    const auto found = wanted.find(&node);
    if (found == wanted.end()) return;
    glm::dmat4 rigid;
    if (rigid_mount_frame(state.world_from_node, rigid)) world_from_point_[*found->second] = rigid;
  }});
}

void FrameTree::add_point(const std::string& name, const Point& point) {
  const auto here = world_from_point_.find(name);
  if (here == world_from_point_.end()) return;
  const auto parent = world_from_point_.find(point.parent);
  if (parent == world_from_point_.end()) {
    transforms_.push_back({world_, of_point(name), here->second, point.moves || !point.parent.empty()});
  } else {
    transforms_.push_back(
        {of_point(point.parent), of_point(name), rigid_inverse(parent->second) * here->second, point.moves});
  }
}

std::optional<glm::dmat4> FrameTree::point_from_sensor(const PlacedSensor& sensor) const {
  const auto point = world_from_point_.find(insertion_point(sensor.sensor));
  if (point == world_from_point_.end()) return std::nullopt;
  const glm::dmat4 place = rigid_inverse(point->second) * sensor.world_from_sensor;
  return is_identity(place) ? glm::dmat4(1) : place;
}

void FrameTree::add_sensor(const PlacedSensor& sensor) {
  if (shares_frame(sensor.sensor)) return;
  const bool moves = moving_sensors_.contains(sensor.sensor.name);
  if (const std::optional<glm::dmat4> place = point_from_sensor(sensor)) {
    transforms_.push_back({of_point(insertion_point(sensor.sensor)), of_sensor(sensor.sensor), *place, moves});
  } else {
    transforms_.push_back({world_, of_sensor(sensor.sensor), sensor.world_from_sensor, moves});
  }
}

// Between its measurements an odometry gives no transform, as a real one does not.
void FrameTree::add_odometry(const PlacedSensor& sensor) {
  const Reading* const reading = sensor.sensor.sensor->reading();
  const std::optional<glm::dmat4> point_from_sensor = this->point_from_sensor(sensor);
  if (sensor.measurement == nullptr || reading == nullptr || !point_from_sensor) return;
  const std::string point = insertion_point(sensor.sensor), frame = odometry_frame(sensor.sensor);
  const glm::dmat4 odom_from_point = measured_pose(*reading) * rigid_inverse(*point_from_sensor);
  if (gives_map(sensor.sensor)) {
    transforms_.push_back({world_, frame, world_from_point_.at(point) * rigid_inverse(odom_from_point), true});
  }
  transforms_.push_back({frame, of_point(point), odom_from_point, true});
}

}  // namespace simvis
