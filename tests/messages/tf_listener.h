// The transforms of a recording as a listener of tf2 has them.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "exchange/messages/types/geometry_types.h"
#include "tests/messages/mcap_file.h"

namespace simvis::ros::test {

inline glm::dmat4 transform_matrix(const Transform& transform) {
  const Quaternion& q = transform.rotation;
  glm::dmat4 matrix = glm::mat4_cast(glm::dquat(q.w, q.x, q.y, q.z));
  matrix[3] = glm::dvec4(transform.translation.x, transform.translation.y, transform.translation.z, 1);
  return matrix;
}

/// What a listener of tf2 has: the last transform of each child.
class TfListener {
 public:
  explicit TfListener(const McapFile& file) {
    for (const auto& each : file.all<TFMessage>("/tf_static")) add(each, true);
  }
  void add(const TFMessage& message, bool fixed = false) {
    for (const TransformStamped& each : message.transforms) {
      parents_[each.child_frame_id] = each;
      (fixed ? fixed_ : moving_).insert(each.child_frame_id);
    }
  }
  /// The transform to a frame from `root`; empty: `root` is not above it.
  std::optional<glm::dmat4> find(const std::string& root, std::string frame) const {
    glm::dmat4 found(1);
    for (std::size_t depth = 0; frame != root; ++depth) {
      const auto parent = parents_.find(frame);
      if (parent == parents_.end() || depth > parents_.size()) return std::nullopt;
      found = transform_matrix(parent->second.transform) * found;
      frame = parent->second.header.frame_id;
    }
    return found;
  }
  std::string parent(const std::string& frame) const { return parents_.at(frame).header.frame_id; }
  const std::set<std::string>& fixed() const { return fixed_; }
  const std::set<std::string>& moving() const { return moving_; }

 private:
  std::map<std::string, TransformStamped> parents_;
  std::set<std::string> fixed_, moving_;
};

}  // namespace simvis::ros::test
