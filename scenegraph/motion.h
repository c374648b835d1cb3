// Motion from differences of world poses, in double. <simvis/pose.h> defines what a Motion is.
//
// The twist from a pose P0 to a pose P1 is the logarithm of inverse(P0) P1 over the time between them (Murray, Li,
// Sastry, "A Mathematical Introduction to Robotic Manipulation", 1994, section 2.3): the constant angular and linear
// velocity, in the moving frame, that leads from one pose to the other along a screw. A constant screw motion has the
// same twist in every interval, so its velocities and accelerations are exact except for rounding.
//
// Rounding. The elements of a rotation are wrong by some u = 2^-53, and positions by some u of their distance from the
// world's origin. Over a time dt an angular velocity is therefore wrong by about 10 u / dt, a velocity by
// 10 u distance / dt, and accelerations by twice that over another dt.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/node.h>
#include <simvis/pose.h>
#include <simvis/state_archive.h>
#include "scenegraph/flattener.h"

namespace simvis {

/// Angular and linear velocity of a frame, in the frame itself.
struct Twist {
  glm::dvec3 angular_radps{0}, linear_mps{0};
};

/// The constant twist that leads from one rigid pose to another in `seconds`, by a turn of at most pi.
Twist twist_between(const glm::dmat4& world_from_before, const glm::dmat4& world_from_now, double seconds);

/// A rigid motion about a point: x becomes point + turn (x - point) + way.
struct Screw {
  glm::dmat3 turn{1.0};
  glm::dvec3 way{0};
};

/// The move from one transform to another, whose difference is rigid: between them is a turn of at most pi. Its item is
/// 0.
ItemMove move_between(const glm::dmat4& world_from_before, const glm::dmat4& world_from_now);

/// The screw motion that an item has still to go, or has gone, at `share` of its move: exp(share twist). -1 leads from
/// now to where it began.
Screw screw_of(const ItemMove& move, double share);

/// The transform of an item at `share` of its move, from that now.
glm::dmat4 place_at(const ItemMove& move, double share, const glm::dmat4& world_from_mesh);

/// The rigid pose at `share` of the way from `first` (0) to `last` (1), along the screw motion that leads from one to
/// the other by a turn of at most pi. Shares outside of [0, 1] extrapolate. What is fixed to each other stays so:
/// pose_between(a, b, s) P = pose_between(a P, b P, s) but for rounding, and place_at() of move_between(a P, b P) is
/// the same place.
glm::dmat4 pose_between(const glm::dmat4& first, const glm::dmat4& last, double share);

/// The poses of one frame at the last frames of the simulation.
class PoseHistory {
 public:
  /// Adds the pose at a later time, or replaces that at the same time.
  void add(std::int64_t time_ns, const glm::dmat4& world_from_body);
  /// The next pose is a first one.
  void clear() { count_ = 0; }
  Motion motion() const;
  void archive(StateArchive& state);

 private:
  struct At {
    std::int64_t time_ns = 0;
    glm::dmat4 world_from_body{1.0};
    void archive(StateArchive& state) { state(time_ns, world_from_body); }
  };
  std::array<At, 3> poses_;  // the last one first
  std::size_t count_ = 0;
};

/// The nodes of a graph that transform what follows, numbered in the order of a walk. A graph that the same commands
/// have made has the same numbers.
class TransformNumbers {
 public:
  explicit TransformNumbers(const Group& root) { add(root); }
  /// Empty for a node that is not in the graph.
  std::optional<std::uint32_t> of(const Transform* node) const;
  /// Null for a number that no node has.
  const Transform* node(std::uint32_t number) const { return number < nodes_.size() ? nodes_[number] : nullptr; }

 private:
  void add(const Group& group);
  std::vector<const Transform*> nodes_;
  std::unordered_map<const Node*, std::uint32_t> numbers_;
};

/// The transforms of the draw list at this frame of the simulation and the previous one.
class ItemMotions {
 public:
  /// Follows the flattener's update() of each frame. `time_ns` is later than that of the last call, or the same: the
  /// frame is then made again.
  void update(const Flattener& flattener, const DrawList& list, std::int64_t time_ns);

  /// The velocity of the matter of an item of `list` at a point of the world: the mean since the previous frame, by the
  /// twist of the item's transform, or by the matter's way if the item does not move rigidly. 0 at an item's first
  /// frame.
  glm::dvec3 velocity_mps(const DrawList& list, std::uint32_t item, const glm::dvec3& point_m) const;

  /// The items of `list` that have moved since the previous frame, in their order. Items that are new or hidden, or
  /// that do not move rigidly, are left out.
  std::vector<ItemMove> moves(const DrawList& list) const;
  /// Nodes that are not there any more are left out.
  void archive(StateArchive& state, const TransformNumbers& numbers);

 private:
  using Key = std::pair<const Transform*, std::uint32_t>;  // a node and the number of its occurrence
  struct KeyHash {
    std::size_t operator()(const Key& key) const { return std::hash<const void*>()(key.first) * 31 + key.second; }
  };
  struct Frame {
    std::int64_t time_ns = 0;
    std::uint64_t structure = 0;
    std::vector<Key> keys;                    // by transform
    std::vector<glm::dmat4> world_from_node;  // by transform
  };
  static void archive(StateArchive& state, const TransformNumbers& numbers, Frame& frame);
  void match();
  std::optional<ItemMove> move_of(std::size_t transform) const;

  Frame now_, before_;
  std::size_t frames_ = 0;                  // 0, 1, or 2 for more
  std::vector<std::size_t> before_of_now_;  // by transform of now_; kNew: there was none
  static constexpr std::size_t kNew = ~std::size_t{0};
};

}  // namespace simvis
