// The frames of a model and what is seen in them. The nodes of its part, and the commands of its joints, are made from
// these for every format alike.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <simvis/node.h>
#include "import/model/model_description.h"

namespace simvis {

/// A place that other objects stand in, with an insertion point, a joint, or neither.
struct ModelStep {
  glm::dmat4 place{1.0};                  ///< in the step before it, or in the last one of the frame around
  std::string point{};                    ///< name of the insertion point at this place; empty: there is none
  ObjectKind object = ObjectKind::frame;  ///< what stands at the point
  std::optional<ModelJoint> joint{};      ///< what moves all that follows, about axes of this place; only with a point
};

/// A link, or another frame of a file: a model that holds links, a site, a copy.
struct ModelFrame {
  std::string name{};
  std::size_t parent = 0;          ///< an earlier frame; of the first frame nothing
  std::vector<ModelStep> steps{};  ///< each within the one before
};

/// The first frame is that of the file. Frames stand behind those around them.
class ModelFrames {
 public:
  explicit ModelFrames(std::string name) { add({.name = std::move(name)}); }
  /// Returns the number of the frame.
  std::size_t add(ModelFrame frame) {
    contents_.push_back({frames_.size(), nullptr});
    frames_.push_back(std::move(frame));
    return frames_.size() - 1;
  }
  /// Adds what is seen in the last step of a frame.
  void add_visual(std::size_t frame, NodePtr visual) { contents_.push_back({frame, std::move(visual)}); }
  ModelFrame& operator[](std::size_t frame) { return frames_[frame]; }

  /// A separator for each frame: { its steps, then its visuals and the frames in it as they were added }. An element at
  /// a point therefore moves what is behind it.
  NodePtr nodes() const;
  /// The joints in the order of the frames. They stay where they are until a frame or a step is added.
  std::vector<ModelJoint*> joints();
  /// The commands of the joints, whose leaders are resolved; see JointCommands, also for the warning that is appended.
  std::vector<std::string> joint_commands(std::vector<std::string>& warnings) const;

 private:
  struct Content {
    std::size_t frame = 0;
    NodePtr visual;  // null: the frame itself, in the one around
  };
  std::vector<ModelFrame> frames_;
  std::vector<Content> contents_;
};

}  // namespace simvis
