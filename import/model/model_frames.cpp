#include "import/model/model_frames.h"

#include <memory>
#include <optional>
#include <utility>

#include "import/model/joint_commands.h"

namespace simvis {

NodePtr ModelFrames::nodes() const {
  std::vector<GroupPtr> separators;
  for (const ModelFrame& frame : frames_) {
    const GroupPtr& own = separators.emplace_back(std::make_shared<Separator>());
    own->name = frame.name;
    for (const ModelStep& step : frame.steps) {
      if (step.place != glm::dmat4(1)) own->add(std::make_shared<Transform>(step.place));
      if (step.point.empty()) continue;
      const auto point = std::make_shared<InsertionPoint>(step.object);
      point->name = step.point;
      own->add(point);
    }
  }
  for (const auto& [frame, visual] : contents_) {
    if (visual != nullptr) {
      separators[frame]->add(visual);
    } else if (frame > 0) {
      separators[frames_[frame].parent]->add(separators[frame]);
    }
  }
  return separators.front();
}

std::vector<ModelJoint*> ModelFrames::joints() {
  std::vector<ModelJoint*> all;
  for (ModelFrame& frame : frames_) {
    for (ModelStep& step : frame.steps) {
      if (step.joint) all.push_back(&*step.joint);
    }
  }
  return all;
}

std::vector<std::string> ModelFrames::joint_commands(std::vector<std::string>& warnings) const {
  JointCommands commands;
  for (const ModelFrame& frame : frames_) {
    for (const ModelStep& step : frame.steps) {
      if (step.joint) commands.add(*step.joint, step.point);
    }
  }
  if (std::optional<std::string> warning = commands.start_warning()) warnings.push_back(std::move(*warning));
  return commands.release();
}

}  // namespace simvis
