// The element `frame`: the name that an insertion point has as a frame of ROS.
//
//   <element type="frame" name="BASE" insert_at="MARVIN" frame="base_link"/>
//
// Frames   that of the insertion point: x forward, y left, z up (REP 103). At ROOT it is the name of the world's frame.
// Parameters  none. The element moves and draws nothing; simvis/ros/frame_tree.h reads the name.
#pragma once

#include <string>

#include <simvis/element.h>
#include <simvis/location.h>

namespace simvis {

class FrameElement : public Element {
 public:
  /// Throws InputError: no such insertion point, no name of a frame.
  explicit FrameElement(const ElementContext& context);
  void update(ParameterView /*values*/) override {}

  const std::string& point() const { return point_; }  ///< its insertion point
  const std::string& frame() const { return frame_; }  ///< the frame_id
  const Location& where() const { return where_; }     ///< of the attribute `frame`

 private:
  std::string point_, frame_;
  Location where_;
};

}  // namespace simvis
