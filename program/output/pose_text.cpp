#include "program/output/pose_text.h"

#include "program/output/number_text.h"

namespace simvis {

namespace {

constexpr NumberFormat kSeconds{NumberFormat::Style::fixed, 9};

std::string pose_numbers(const FrameTime& time, const glm::dmat4& matrix, char separator) {
  const Pose3 pose = pose_of(matrix);
  const glm::dquat& q = pose.orientation;
  std::string text;
  append_number(text, kSeconds, static_cast<double>(time.time_ns) / 1e9);
  for (const double value : {pose.position_m.x, pose.position_m.y, pose.position_m.z, q.x, q.y, q.z, q.w}) {
    text += separator;
    append_exact(text, value + 0.0);  // -0 is printed as 0
  }
  return text + '\n';
}

}  // namespace

std::string pose_line(const FrameTime& time, const glm::dmat4& matrix) {
  return std::to_string(time.index) + ',' + pose_numbers(time, matrix, ',');
}

std::string tum_line(const FrameTime& time, const glm::dmat4& matrix) { return pose_numbers(time, matrix, ' '); }

}  // namespace simvis
