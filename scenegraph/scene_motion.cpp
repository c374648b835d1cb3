#include "scenegraph/scene_motion.h"

#include <algorithm>
#include <functional>
#include <unordered_map>

#include <simvis/pose.h>
#include "engine/base/assert.h"
#include "scenegraph/motion.h"
#include "scenegraph/motion_path.h"

namespace simvis {
namespace {

/// Whether turning about one axis, then changing the axes, is changing the axes, then turning about another one. It is
/// not where a chain is stretched across its joint's axis.
bool turns_as(const glm::dmat3& axes, const glm::dvec3& inner_rad, const glm::dvec3& outer_rad) {
  double error = 0, size = 0;
  for (int i = 0; i < 3; ++i) {
    glm::dvec3 unit(0);
    unit[i] = 1;
    error = std::max(error, glm::distance(axes * glm::cross(inner_rad, unit), glm::cross(outer_rad, axes[i])));
    size = std::max(size, glm::length(axes[i]));
  }
  return error <= kMotionRigidity * size;
}

/// The screw of a joint from one pose to another, with the axes of the world. Empty if it is not one: the joint changes
/// its scale, or the chain in front of it is stretched.
std::optional<ScrewMotion> joint_screw(const glm::dmat4& world_from_parent, const glm::dmat4& before,
                                       const glm::dmat4& now) {
  if (!is_rigid(glm::dmat4(glm::dmat3(now) * glm::inverse(glm::dmat3(before))), kMotionRigidity)) return std::nullopt;
  const ScrewMotion own = screw_between(before, now);
  const glm::dmat3 axes(world_from_parent);
  const double angle_rad = glm::length(own.turn_rad);
  glm::dvec3 turn_rad(0);
  if (angle_rad != 0) turn_rad = glm::normalize(axes * own.turn_rad) * angle_rad;
  if (glm::determinant(axes) < 0) turn_rad = -turn_rad;  // a mirror turns the other way
  if (!turns_as(axes, own.turn_rad, turn_rad)) return std::nullopt;
  return ScrewMotion{.point_m = glm::dvec3(world_from_parent * glm::dvec4(own.point_m, 1)),
                     .turn_rad = turn_rad,
                     .way_m = axes * own.way_m};
}

}  // namespace

const glm::dmat4& SceneMotion::Track::at(std::int64_t time_ns) const {
  const auto after = std::ranges::upper_bound(knots, time_ns, {}, &Knot::time_ns);
  SIMVIS_ASSERT(after != knots.begin());
  return std::prev(after)->parent_from_node;
}

void SceneMotion::update(const Flattener& flattener, const DrawList& list, std::int64_t time_ns) {
  // A frame that failed may be followed by an earlier one.
  const bool goes_back = !times_ns_.empty() && times_ns_.back() > time_ns;
  while (!times_ns_.empty() && times_ns_.back() >= time_ns) times_ns_.pop_back();
  times_ns_.push_back(time_ns);
  const bool has_moved = revisions_.transforms != list.revisions.transforms;
  if (!is_matched_ || revisions_.structure != list.revisions.structure) {
    match(flattener, list.world_from_node.size());
    is_matched_ = true;
  } else if (!has_moved && !goes_back) {
    return;
  }
  revisions_ = list.revisions;
  for (std::uint32_t t = 1; t < tracks_.size(); ++t) {
    std::vector<Knot>& knots = tracks_[t].knots;
    const glm::dmat4& matrix = flattener.node_of(t)->matrix();
    while (!knots.empty() && knots.back().time_ns >= time_ns) knots.pop_back();
    if (knots.empty() || knots.back().parent_from_node != matrix) knots.push_back({time_ns, matrix});
  }
}

// The graph has changed since: transforms are matched by their nodes.
void SceneMotion::match(const Flattener& flattener, std::size_t count) {
  struct KeyHash {
    std::size_t operator()(const Key& key) const { return std::hash<const void*>()(key.first) * 31 + key.second; }
  };
  std::unordered_map<Key, Track*, KeyHash> known;
  for (Track& each : tracks_) known.emplace(each.key, &each);
  std::unordered_map<const Transform*, std::uint32_t> occurrences;
  std::vector<Track> tracks(count);
  for (std::uint32_t t = 0; t < count; ++t) {
    Track& track = tracks[t];
    const Transform* const node = flattener.node_of(t);
    track.key = {node, occurrences[node]++};
    track.parent = flattener.parent_of(t);
    track.parent_key = tracks[track.parent].key;
    const auto found = known.find(track.key);
    if (found != known.end() && found->second->parent_key == track.parent_key) {
      track.knots = std::move(found->second->knots);
    }
  }
  tracks_ = std::move(tracks);
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

void SceneMotion::archive(StateArchive& state, const TransformNumbers& numbers) {
  constexpr std::uint32_t kNoNode = 0;  // the world, in which the outermost nodes stand
  const auto archive_key = [&](Key& key) {
    std::uint32_t number = key.first == nullptr ? kNoNode : *numbers.of(key.first) + 1;
    state(number, key.second);
    key.first = number == kNoNode ? nullptr : numbers.node(number - 1);
    state.require(number == kNoNode || key.first != nullptr);
  };
  const auto is_there = [&](const Key& key) { return key.first == nullptr || numbers.of(key.first); };
  std::vector<Track> tracks;
  for (const Track& each : state.is_reading() ? std::vector<Track>() : tracks_) {
    if (is_there(each.key) && is_there(each.parent_key) && !each.knots.empty()) tracks.push_back(each);
  }
  std::size_t count = tracks.size();
  constexpr std::size_t kKnotSize = sizeof(std::int64_t) + sizeof(glm::dmat4);
  state.count(count, 3 * sizeof(std::uint64_t) + kKnotSize);
  tracks.resize(count);
  for (Track& each : tracks) {
    archive_key(each.key);
    archive_key(each.parent_key);
    state(each.knots);
    state.require(!each.knots.empty() && std::ranges::is_sorted(each.knots, {}, &Knot::time_ns));
    for (const Knot& knot : each.knots) state.require_past(knot.time_ns);
  }
  state(times_ns_);
  state.require(std::ranges::is_sorted(times_ns_));
  for (const std::int64_t time_ns : times_ns_) state.require_past(time_ns);
  if (!state.is_reading()) return;
  tracks_ = std::move(tracks);
  is_matched_ = false;
}

void SceneMotion::forget_before(std::int64_t time_ns) {
  if (times_ns_.empty() || times_ns_.front() >= time_ns) return;
  times_ns_.erase(times_ns_.begin(), std::ranges::lower_bound(times_ns_, time_ns));
  for (Track& track : tracks_) {
    const auto after = std::ranges::upper_bound(track.knots, time_ns, {}, &Knot::time_ns);
    if (after - track.knots.begin() > 1) track.knots.erase(track.knots.begin(), std::prev(after));
  }
}

std::vector<std::int64_t> SceneMotion::times_from(std::int64_t time_ns) const {
  return {std::ranges::lower_bound(times_ns_, time_ns), times_ns_.end()};
}

std::vector<std::shared_ptr<const MotionPath>> SceneMotion::paths(std::span<const std::int64_t> times_ns) const {
  std::vector<std::shared_ptr<const MotionPath>> paths(tracks_.size());
  if (times_ns.size() < 2) return paths;
  std::vector<bool> is_known(tracks_.size(), true);
  for (std::uint32_t t = 1; t < tracks_.size(); ++t) {
    const Track& track = tracks_[t];
    is_known[t] = is_known[track.parent] && track.is_known_at(times_ns.front());
    if (!is_known[t]) continue;
    const bool has_moved = track.knots.back().time_ns > times_ns.front();
    paths[t] = has_moved ? path_of(t, times_ns) : paths[track.parent];
  }
  return paths;
}

std::shared_ptr<const MotionPath> SceneMotion::path_of(std::uint32_t transform,
                                                       std::span<const std::int64_t> times_ns) const {
  std::vector<std::uint32_t> chain;
  for (std::uint32_t t = transform; t != 0; t = tracks_[t].parent) chain.insert(chain.begin(), t);
  const auto world_at = [&](std::int64_t time_ns) {
    glm::dmat4 world(1.0);
    for (const std::uint32_t t : chain) world = world * tracks_[t].at(time_ns);
    return world;
  };
  const glm::dmat4 now = world_at(times_ns.back());
  const auto share = [&](std::int64_t time_ns) {
    return static_cast<double>(time_ns - times_ns.back()) / static_cast<double>(times_ns.back() - times_ns.front());
  };
  auto path = std::make_shared<MotionPath>();
  for (std::size_t k = 0; k + 1 < times_ns.size(); ++k) {
    std::optional<MotionPiece> piece = piece_of(chain, times_ns[k], times_ns[k + 1]);
    if (!piece) return nullptr;
    piece->begin = share(times_ns[k]);
    piece->end = share(times_ns[k + 1]);
    const glm::dmat4 at_end = world_at(times_ns[k + 1]);
    piece->point_m = glm::dvec3(now[3]);
    piece->until_end = {glm::dmat3(at_end) * glm::inverse(glm::dmat3(now)), glm::dvec3(at_end[3]) - glm::dvec3(now[3])};
    path->pieces.push_back(std::move(*piece));
  }
  const auto stands = [](const MotionPiece& each) { return each.joints.empty(); };
  return std::ranges::all_of(path->pieces, stands) ? nullptr : path;
}

std::optional<MotionPiece> SceneMotion::piece_of(std::span<const std::uint32_t> chain, std::int64_t begin_ns,
                                                 std::int64_t end_ns) const {
  MotionPiece piece;
  glm::dmat4 world(1.0);
  for (const std::uint32_t t : chain) {
    const glm::dmat4 &before = tracks_[t].at(begin_ns), &now = tracks_[t].at(end_ns);
    if (before != now) {
      const std::optional<ScrewMotion> screw = joint_screw(world, before, now);
      if (!screw) return std::nullopt;
      piece.joints.insert(piece.joints.begin(), *screw);
    }
    world = world * now;
  }
  return piece;
}

std::vector<std::optional<glm::dmat4>> SceneMotion::world_from_node(std::int64_t time_ns) const {
  std::vector<std::optional<glm::dmat4>> worlds(tracks_.size());
  worlds[0] = glm::dmat4(1.0);
  for (std::uint32_t t = 1; t < tracks_.size(); ++t) {
    const std::optional<glm::dmat4>& parent = worlds[tracks_[t].parent];
    if (parent && tracks_[t].is_known_at(time_ns)) worlds[t] = *parent * tracks_[t].at(time_ns);
  }
  return worlds;
}

}  // namespace simvis
