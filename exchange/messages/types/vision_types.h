// Messages of vision_msgs 4, as of ROS 2 Humble and later.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "exchange/messages/field.h"
#include "exchange/messages/types/geometry_types.h"
#include "exchange/messages/types/std_types.h"

namespace simvis::ros {

struct Point2D {
  SIMVIS_MESSAGE("vision_msgs/msg/Point2D", x, y);
  double x = 0;
  double y = 0;
};

struct Pose2D {
  SIMVIS_MESSAGE("vision_msgs/msg/Pose2D", position, theta);
  Point2D position;
  double theta = 0;
};

struct BoundingBox2D {
  SIMVIS_MESSAGE("vision_msgs/msg/BoundingBox2D", center, size_x, size_y);
  Pose2D center;      ///< pixels
  double size_x = 0;  ///< pixels
  double size_y = 0;
};

struct BoundingBox3D {
  SIMVIS_MESSAGE("vision_msgs/msg/BoundingBox3D", center, size);
  Pose center;
  Vector3 size;
};

struct ObjectHypothesis {
  SIMVIS_MESSAGE("vision_msgs/msg/ObjectHypothesis", class_id, score);
  std::string class_id;
  double score = 0;
};

struct ObjectHypothesisWithPose {
  SIMVIS_MESSAGE("vision_msgs/msg/ObjectHypothesisWithPose", hypothesis, pose);
  ObjectHypothesis hypothesis;
  PoseWithCovariance pose;
};

struct Detection2D {
  SIMVIS_MESSAGE("vision_msgs/msg/Detection2D", header, results, bbox, id);
  Header header;
  std::vector<ObjectHypothesisWithPose> results;
  BoundingBox2D bbox;
  std::string id;  ///< the same for one object in all messages
};

struct Detection2DArray {
  SIMVIS_MESSAGE("vision_msgs/msg/Detection2DArray", header, detections);
  Header header;
  std::vector<Detection2D> detections;
};

struct Detection3D {
  SIMVIS_MESSAGE("vision_msgs/msg/Detection3D", header, results, bbox, id);
  Header header;
  std::vector<ObjectHypothesisWithPose> results;
  BoundingBox3D bbox;
  std::string id;  ///< as Detection2D::id
};

struct Detection3DArray {
  SIMVIS_MESSAGE("vision_msgs/msg/Detection3DArray", header, detections);
  Header header;
  std::vector<Detection3D> detections;
};

}  // namespace simvis::ros
