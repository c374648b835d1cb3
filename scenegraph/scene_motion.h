// The poses of a scene's transforms at the frames of a simulation, and the paths between them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/motion_path.h>
#include <simvis/node.h>
#include <simvis/state_archive.h>
#include "scenegraph/flattener.h"

namespace simvis {

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

/// Each transform keeps its matrix relative to the one in front of it, and when it changed: what stands still costs one
/// matrix. A transform that is new, or that another one has been put in front of, is unknown before that frame.
class SceneMotion {
 public:
  /// Follows the flattener's update() of a frame. If `time_ns` is not later than that of the last calls, those frames
  /// are made again.
  void update(const Flattener& flattener, const DrawList& list, std::int64_t time_ns);

  /// Forgets the frames before this one.
  void forget_before(std::int64_t time_ns);

  /// The times of the frames from this one on, ascending.
  std::vector<std::int64_t> times_from(std::int64_t time_ns) const;

  /// By transform of the last update(): its path over times at which there were frames, ascending. Null: it stands
  /// still, is unknown at the first time, or does not move rigidly.
  std::vector<std::shared_ptr<const MotionPath>> paths(std::span<const std::int64_t> times_ns) const;

  /// By transform of the last update(): DrawList::world_from_node at an earlier frame; empty if it is unknown.
  std::vector<std::optional<glm::dmat4>> world_from_node(std::int64_t time_ns) const;

  /// Nodes that are not there any more are left out.
  void archive(StateArchive& state, const TransformNumbers& numbers);

 private:
  using Key = std::pair<const Transform*, std::uint32_t>;  // a node and the number of its occurrence
  struct Knot {
    std::int64_t time_ns = 0;
    glm::dmat4 parent_from_node{1.0};  // from then on
    void archive(StateArchive& state) {
      state(time_ns);
      state.finite(parent_from_node);
    }
  };
  struct Track {
    Key key{}, parent_key{};
    std::uint32_t parent = 0;
    std::vector<Knot> knots;  // ascending, at least one but for entry 0

    bool is_known_at(std::int64_t time_ns) const { return knots.front().time_ns <= time_ns; }
    const glm::dmat4& at(std::int64_t time_ns) const;
  };
  void match(const Flattener& flattener, std::size_t count);
  std::shared_ptr<const MotionPath> path_of(std::uint32_t transform, std::span<const std::int64_t> times_ns) const;
  std::optional<MotionPiece> piece_of(std::span<const std::uint32_t> chain, std::int64_t begin_ns,
                                      std::int64_t end_ns) const;

  std::vector<Track> tracks_;           // by transform, once they are matched
  bool is_matched_ = false;             // with the flattener
  std::vector<std::int64_t> times_ns_;  // ascending
  DrawList::Revisions revisions_{};
};

}  // namespace simvis
