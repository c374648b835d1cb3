#include "scenegraph/motion_path.h"

#include <algorithm>
#include <cmath>

#include "scenegraph/motion.h"

namespace simvis {
namespace {

// What an earlier displacement has moved. The way is a sum of differences, which keep their digits far from the world's
// origin.
void follow(const glm::dvec3& about_m, const Displacement& next, const glm::dvec3& point_m, Displacement& sum) {
  const glm::dvec3 from_point = point_m - about_m + sum.way_m;
  sum.way_m += (next.turn * from_point - from_point) + next.way_m;
  sum.turn = next.turn * sum.turn;
}

const MotionPiece& piece_at(const MotionPath& path, double share) {
  const auto found = std::ranges::find_if(path.pieces, [&](const MotionPiece& each) { return share <= each.end; });
  return found == path.pieces.end() ? path.pieces.back() : *found;
}

}  // namespace

ScrewMotion screw_between(const glm::dmat4& world_from_before, const glm::dmat4& world_from_now) {
  const glm::dmat3 turn = glm::dmat3(world_from_now) * glm::inverse(glm::dmat3(world_from_before));
  glm::dmat4 frame_now(1.0), frame_before(glm::transpose(turn));  // both stand in the origin
  frame_now[3] = world_from_now[3];
  frame_before[3] = world_from_before[3];
  const Twist twist = twist_between(frame_before, frame_now, 1);
  return {.point_m = glm::dvec3(world_from_now[3]), .turn_rad = twist.angular_radps, .way_m = twist.linear_mps};
}

Displacement screw_at(const ScrewMotion& screw, double share) {
  const glm::dvec3 w = share * screw.turn_rad, v = share * screw.way_m;
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

MotionPath path_between(const glm::dmat4& world_from_before, const glm::dmat4& world_from_now) {
  MotionPath path;
  if (world_from_before == world_from_now) return path;
  path.pieces.push_back({.joints = {screw_between(world_from_before, world_from_now)}});
  return path;
}

Displacement displacement(const MotionPath& path, double share, const glm::dvec3& point_m) {
  Displacement sum;
  if (path.pieces.empty() || share == 0) return sum;
  const MotionPiece& piece = piece_at(path, share);
  if (piece.end < 0) follow(piece.point_m, piece.until_end, point_m, sum);
  const double back = (share - piece.end) / (piece.end - piece.begin);
  for (const ScrewMotion& joint : piece.joints) follow(joint.point_m, screw_at(joint, back), point_m, sum);
  return sum;
}

glm::dmat4 place_at(const MotionPath& path, double share, const glm::dmat4& world_from_frame) {
  const glm::dvec3 origin(world_from_frame[3]);
  const Displacement then = displacement(path, share, origin);
  glm::dmat4 place(then.turn * glm::dmat3(world_from_frame));
  place[3] = glm::dvec4(origin + then.way_m, 1);
  return place;
}

glm::dmat4 pose_between(const glm::dmat4& first, const glm::dmat4& last, double share) {
  return place_at(path_between(first, last), share - 1, last);
}

std::size_t displacements(const MotionPath& path) {
  std::size_t most = 0;
  for (const MotionPiece& piece : path.pieces) most = std::max(most, piece.joints.size() + (piece.end < 0 ? 1 : 0));
  return most;
}

double extrapolation(const MotionPath& path, double share) {
  if (path.pieces.empty()) return 1;
  const MotionPiece& first = path.pieces.front();
  return std::max(1.0, (first.end - share) / (first.end - first.begin));
}

double rounded_length_m(const MotionPath& path, const glm::dvec3& point_m, double parts) {
  constexpr double kMaxMove = 2;  // a turn moves a point by at most twice its distance
  double longest_m = 0;
  for (const MotionPiece& piece : path.pieces) {
    const double times = &piece == &path.pieces.front() ? parts : 1;
    double moved_m = glm::length(piece.until_end.way_m);
    double length_m = piece.end < 0 ? moved_m + glm::distance(point_m, piece.point_m) : 0;
    for (const ScrewMotion& joint : piece.joints) {
      const double from_point_m = glm::distance(point_m, joint.point_m) + moved_m;
      const double way_m = times * glm::length(joint.way_m), turn_rad = times * glm::length(joint.turn_rad);
      length_m += from_point_m + way_m;
      moved_m += way_m + std::min(turn_rad, kMaxMove) * from_point_m;
    }
    longest_m = std::max(longest_m, length_m);
  }
  return longest_m;
}

}  // namespace simvis
