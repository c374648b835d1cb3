#include "scenegraph/motion.h"

#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <unordered_map>
#include <utility>

#include <simvis/pose.h>

namespace simvis {

namespace {

// Products of poses stay rigid within this; a transform that differs more was scaled, sheared or mirrored.
constexpr double kMotionRigidity = 1e-9;

double seconds_between(std::int64_t before_ns, std::int64_t now_ns) {
  return static_cast<double>(now_ns - before_ns) / 1e9;
}

/// The rotation as its axis times its angle, at most pi.
glm::dvec3 rotation_vector_of(const glm::dmat3& rotation) {
  const glm::dquat q = glm::normalize(glm::quat_cast(rotation)), shorter = q.w < 0 ? -q : q;
  const glm::dvec3 axis(shorter.x, shorter.y, shorter.z);
  const double sine = glm::length(axis);
  return sine == 0 ? glm::dvec3(0) : axis * (2 * std::atan2(sine, shorter.w) / sine);
}

/// (1 - (angle / 2) cot(angle / 2)) / angle^2, which logarithm() multiplies by angle^2. Its series is used where the
/// difference would cancel. At the limit between both, cancellation and the first missing term, angle^4 / 30240, are
/// below 2^-53 after that factor.
double second_coefficient(double angle) {
  constexpr double kSeriesBelow = 1e-3;
  if (angle < kSeriesBelow) return 1.0 / 12 + angle * angle / 720;
  return (1 - angle / 2 / std::tan(angle / 2)) / (angle * angle);
}

/// The logarithm of a rigid matrix: rotation vector and the linear part of the screw.
std::pair<glm::dvec3, glm::dvec3> logarithm(const glm::dmat4& rigid) {
  const glm::dvec3 turn = rotation_vector_of(glm::dmat3(rigid)), moved(rigid[3]);
  const glm::dvec3 across = glm::cross(turn, moved);
  return {turn, moved - 0.5 * across + second_coefficient(glm::length(turn)) * glm::cross(turn, across)};
}

}  // namespace

Twist twist_between(const glm::dmat4& world_from_before, const glm::dmat4& world_from_now, double seconds) {
  const glm::dmat3 before_from_world = glm::transpose(glm::dmat3(world_from_before));
  // The difference of the positions is taken first, so that it keeps its digits far from the origin.
  glm::dmat4 before_from_now(before_from_world * glm::dmat3(world_from_now));
  before_from_now[3] =
      glm::dvec4(before_from_world * (glm::dvec3(world_from_now[3]) - glm::dvec3(world_from_before[3])), 1);
  const auto [turn, screw] = logarithm(before_from_now);
  return {turn / seconds, screw / seconds};
}

ItemMove move_between(const glm::dmat4& world_from_before, const glm::dmat4& world_from_now) {
  const glm::dmat3 turn = glm::dmat3(world_from_now) * glm::inverse(glm::dmat3(world_from_before));
  glm::dmat4 frame_now(1.0), frame_before(glm::transpose(turn));  // both stand in the origin
  frame_now[3] = world_from_now[3];
  frame_before[3] = world_from_before[3];
  const Twist twist = twist_between(frame_before, frame_now, 1);
  return {.point_m = glm::dvec3(world_from_now[3]), .turn_rad = twist.angular_radps, .way_m = twist.linear_mps};
}

Screw screw_of(const ItemMove& move, double share) {
  const glm::dvec3 w = share * move.turn_rad, v = share * move.way_m;
  const double angle = glm::length(w), half = angle / 2;
  // sin(a) / a, (1 - cos a) / a^2 and (a - sin a) / a^3. The missing terms of the series are below 2^-53 of what they
  // are added to.
  constexpr double kSeriesBelow = 1e-3;
  const bool small = angle < kSeriesBelow;
  const double sine = small ? 1 - angle * angle / 6 : std::sin(angle) / angle;
  const double half_sine = small ? 1 - half * half / 6 : std::sin(half) / half;
  const double versine = half_sine * half_sine / 2;
  const double rest = small ? (1 - angle * angle / 20) / 6 : (1 - sine) / (angle * angle);
  const glm::dmat3 cross{{0, w.z, -w.y}, {-w.z, 0, w.x}, {w.y, -w.x, 0}}, square = cross * cross;
  return {glm::dmat3(1.0) + sine * cross + versine * square, v + versine * (cross * v) + rest * (square * v)};
}

glm::dmat4 place_at(const ItemMove& move, double share, const glm::dmat4& world_from_mesh) {
  const Screw screw = screw_of(move, share);
  glm::dmat4 place(screw.turn * glm::dmat3(world_from_mesh));
  const glm::dvec3 origin = glm::dvec3(world_from_mesh[3]) - move.point_m;
  place[3] = glm::dvec4(move.point_m + screw.way + screw.turn * origin, 1);
  return place;
}

glm::dmat4 pose_between(const glm::dmat4& first, const glm::dmat4& last, double share) {
  return place_at(move_between(first, last), share - 1, last);
}

void PoseHistory::add(std::int64_t time_ns, const glm::dmat4& world_from_body) {
  if (count_ > 0 && poses_[0].time_ns == time_ns) {
    poses_[0].world_from_body = world_from_body;
    return;
  }
  poses_[2] = poses_[1];
  poses_[1] = poses_[0];
  poses_[0] = {time_ns, world_from_body};
  count_ = count_ < poses_.size() ? count_ + 1 : count_;
}

Motion PoseHistory::motion() const {
  if (count_ < 2) return {};
  const auto twist = [&](std::size_t before, std::size_t now) {
    return twist_between(poses_[before].world_from_body, poses_[now].world_from_body,
                         seconds_between(poses_[before].time_ns, poses_[now].time_ns));
  };
  const Twist last = twist(1, 0);
  glm::dvec3 angular_change(0), linear_change(0);  // per second
  if (count_ > 2) {
    const Twist earlier = twist(2, 1);
    const double between_s = seconds_between(poses_[2].time_ns, poses_[0].time_ns) / 2;
    angular_change = (last.angular_radps - earlier.angular_radps) / between_s;
    linear_change = (last.linear_mps - earlier.linear_mps) / between_s;
  }
  const glm::dmat3 world_from_body(poses_[0].world_from_body);
  return {.velocity_mps = world_from_body * last.linear_mps,
          .angular_velocity_radps = world_from_body * last.angular_radps,
          .acceleration_mps2 = world_from_body * (linear_change + glm::cross(last.angular_radps, last.linear_mps)),
          .angular_acceleration_radps2 = world_from_body * angular_change};
}

void ItemMotions::update(const Flattener& flattener, const DrawList& list, std::int64_t time_ns) {
  const bool again = frames_ > 0 && now_.time_ns == time_ns;
  if (!again) {
    std::swap(before_, now_);
    frames_ = frames_ < 2 ? frames_ + 1 : frames_;
  }
  now_.time_ns = time_ns;
  now_.world_from_node = list.world_from_node;
  now_.structure = list.revisions.structure;
  now_.keys.clear();
  std::unordered_map<const Transform*, std::uint32_t> occurrences;
  for (std::uint32_t t = 0; t < list.world_from_node.size(); ++t) {
    const Transform* const node = flattener.node_of(t);
    now_.keys.emplace_back(node, occurrences[node]++);
  }
  match();
}

// The graph may have changed between the frames: transforms are matched by their nodes.
void ItemMotions::match() {
  before_of_now_.assign(now_.keys.size(), kNew);
  if (frames_ < 2) return;
  std::unordered_map<Key, std::size_t, KeyHash> known;
  for (std::size_t t = 0; t < before_.keys.size(); ++t) known.emplace(before_.keys[t], t);
  for (std::size_t t = 0; t < now_.keys.size(); ++t) {
    const auto found = known.find(now_.keys[t]);
    if (found != known.end()) before_of_now_[t] = found->second;
  }
}

glm::dvec3 ItemMotions::velocity_mps(const DrawList& list, std::uint32_t item, const glm::dvec3& point_m) const {
  const std::uint32_t transform = list.items[item].transform;
  if (transform >= before_of_now_.size() || before_of_now_[transform] == kNew) return glm::dvec3(0);
  const glm::dmat4 &now = now_.world_from_node[transform], &before = before_.world_from_node[before_of_now_[transform]];
  if (now == before) return glm::dvec3(0);
  const double seconds = seconds_between(before_.time_ns, now_.time_ns);
  const glm::dmat4 now_from_before = now * glm::inverse(before);
  if (!is_rigid(now_from_before, kMotionRigidity)) {
    return (point_m - glm::dvec3(glm::inverse(now_from_before) * glm::dvec4(point_m, 1))) / seconds;
  }
  // A frame that stands in the point with the axes of the world: it was at the point's former place, turned back.
  glm::dmat4 frame_now(1.0);
  frame_now[3] = glm::dvec4(point_m, 1);
  const glm::dmat4 frame_before = rigid_inverse(now_from_before) * frame_now;
  return twist_between(frame_before, frame_now, seconds).linear_mps;
}

// The turn and the ways of the origin are differences of poses, which keep their digits far from the world's origin.
std::optional<ItemMove> ItemMotions::move_of(std::size_t transform) const {
  if (transform >= before_of_now_.size() || before_of_now_[transform] == kNew) return std::nullopt;
  const glm::dmat4 &now = now_.world_from_node[transform], &before = before_.world_from_node[before_of_now_[transform]];
  if (now == before) return std::nullopt;
  const glm::dmat4 turn(glm::dmat3(now) * glm::inverse(glm::dmat3(before)));
  if (!is_rigid(turn, kMotionRigidity)) return std::nullopt;
  return move_between(before, now);
}

std::vector<ItemMove> ItemMotions::moves(const DrawList& list) const {
  std::vector<std::optional<ItemMove>> by_transform(list.world_from_node.size());
  for (std::size_t t = 0; t < by_transform.size(); ++t) by_transform[t] = move_of(t);
  std::vector<ItemMove> moves;
  for (std::uint32_t i = 0; i < list.items.size(); ++i) {
    const std::optional<ItemMove>& move = by_transform[list.items[i].transform];
    if (!move || !list.items[i].visible) continue;
    moves.push_back(*move);
    moves.back().item = i;
  }
  return moves;
}

void PoseHistory::archive(StateArchive& state) {
  state(poses_, count_);
  state.require(count_ <= poses_.size());
}

std::optional<std::uint32_t> TransformNumbers::of(const Transform* node) const {
  const auto found = numbers_.find(node);
  return found == numbers_.end() ? std::nullopt : std::optional(found->second);
}

// A node that several parts share counts where it comes first.
void TransformNumbers::add(const Group& group) {
  if (!numbers_.emplace(&group, nodes_.size()).second) return;
  for (const NodePtr& child : group.children()) {
    if (const auto* const below = dynamic_cast<const Group*>(child.get())) {
      add(*below);
    } else if (const auto* const transform = dynamic_cast<const Transform*>(child.get())) {
      if (numbers_.emplace(transform, nodes_.size()).second) nodes_.push_back(transform);
    }
  }
}

void ItemMotions::archive(StateArchive& state, const TransformNumbers& numbers) {
  state(frames_);
  state.require(frames_ <= 2);
  for (Frame* const frame : {&now_, &before_}) archive(state, numbers, *frame);
  if (state.is_reading()) match();
}

void ItemMotions::archive(StateArchive& state, const TransformNumbers& numbers, Frame& frame) {
  constexpr std::uint32_t kNoNode = 0;  // what no node transforms
  std::vector<std::uint32_t> nodes, occurrences;
  std::vector<glm::dmat4> places;
  for (std::size_t i = 0; i < frame.keys.size(); ++i) {
    const std::optional<std::uint32_t> number = numbers.of(frame.keys[i].first);
    if (!number && frame.keys[i].first != nullptr) continue;
    nodes.push_back(number ? *number + 1 : kNoNode);
    occurrences.push_back(frame.keys[i].second);
    places.push_back(frame.world_from_node[i]);
  }
  state(frame.time_ns, nodes, occurrences, places);
  state.require(occurrences.size() == nodes.size() && places.size() == nodes.size());
  if (!state.is_reading()) return;
  frame.keys.clear();
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Transform* const node = nodes[i] == kNoNode ? nullptr : numbers.node(nodes[i] - 1);
    state.require(nodes[i] == kNoNode || node != nullptr);
    frame.keys.emplace_back(node, occurrences[i]);
  }
  frame.world_from_node = std::move(places);
}

}  // namespace simvis
