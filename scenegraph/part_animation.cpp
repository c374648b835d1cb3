#include "scenegraph/part_animation.h"

#include <algorithm>
#include <cmath>

namespace simvis {
namespace {

// The angle comes from the arc tangent of the chords, which is accurate for small angles too.
glm::dvec4 slerp(const glm::dvec4& from, const glm::dvec4& to, double part) {
  const glm::dvec4 target = glm::dot(from, to) < 0 ? -to : to;
  const double angle = 2 * std::atan2(glm::length(from - target), glm::length(from + target));
  const double sine = std::sin(angle);
  if (sine == 0) return from;
  return (std::sin(angle * (1 - part)) * from + std::sin(angle * part) * target) / sine;
}

glm::dvec4 unit_or(const glm::dvec4& q, const glm::dvec4& otherwise) {
  const double length = glm::length(q);
  return length > 0 ? q / length : otherwise;
}

glm::dvec4 quaternion(const float* v) { return glm::normalize(glm::dvec4(v[0], v[1], v[2], v[3])); }

void store(const glm::dvec4& q, std::span<double> value) {
  for (std::size_t i = 0; i < 4; ++i) value[i] = q[static_cast<int>(i)];
}

// The interpolation between two keys of a sampler. `part` is the fraction of the interval, 0 to 1.
class Segment {
 public:
  Segment(const AnimationSampler& sampler, std::size_t key, double part)
      : cubic_(sampler.interpolation == AnimationInterpolation::cubic_spline),
        stride_(sampler.width * (cubic_ ? 3 : 1)),
        first_(sampler.values->data() + key * stride_),
        value_(first_ + (cubic_ ? sampler.width : 0)),
        width_(sampler.width),
        part_(part) {}

  void hold(bool rotation, std::span<double> value) const {
    if (rotation) return store(quaternion(value_), value);
    std::copy(value_, value_ + width_, value.begin());
  }

  void linear(bool rotation, std::span<double> value) const {
    const float* const next = value_ + stride_;
    if (rotation) return store(slerp(quaternion(value_), quaternion(next), part_), value);
    for (std::size_t i = 0; i < width_; ++i) value[i] = (1 - part_) * value_[i] + part_ * next[i];
  }

  // Cubic Hermite interpolation. The tangents are per second.
  void cubic(bool rotation, double length_s, std::span<double> value) const {
    const float *const out_tangent = value_ + width_, *const in_tangent = first_ + stride_;
    const float* const next = value_ + stride_;
    const double t = part_, t2 = t * t, t3 = t2 * t;
    for (std::size_t i = 0; i < width_; ++i) {
      value[i] = (2 * t3 - 3 * t2 + 1) * value_[i] + length_s * (t3 - 2 * t2 + t) * out_tangent[i] +
                 (3 * t2 - 2 * t3) * next[i] + length_s * (t3 - t2) * in_tangent[i];
    }
    if (rotation) store(unit_or({value[0], value[1], value[2], value[3]}, quaternion(value_)), value);
  }

 private:
  bool cubic_;
  std::size_t stride_;
  const float *first_, *value_;
  std::size_t width_;
  double part_;
};

}  // namespace

glm::dmat4 matrix_of(const LocalPose& pose) {
  const double x = pose.rotation.x, y = pose.rotation.y, z = pose.rotation.z, w = pose.rotation.w;
  glm::dmat4 m(1);
  m[0] = glm::dvec4(1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y), 0) * pose.scale.x;
  m[1] = glm::dvec4(2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x), 0) * pose.scale.y;
  m[2] = glm::dvec4(2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y), 0) * pose.scale.z;
  m[3] = glm::dvec4(pose.translation, 1);
  return m;
}

void sample_animation(const AnimationSampler& sampler, AnimatedProperty property, double time_s,
                      std::span<double> value) {
  const std::vector<float>& times = *sampler.times_s;
  const bool rotation = property == AnimatedProperty::rotation;
  const auto later = std::upper_bound(times.begin(), times.end(), time_s,
                                      [](double time, float key) { return time < static_cast<double>(key); });
  if (later == times.begin()) return Segment(sampler, 0, 0).hold(rotation, value);
  const auto key = static_cast<std::size_t>(later - times.begin()) - 1;
  if (later == times.end() || sampler.interpolation == AnimationInterpolation::step) {
    return Segment(sampler, key, 0).hold(rotation, value);
  }
  const double length_s = static_cast<double>(times[key + 1]) - times[key];
  const Segment segment(sampler, key, (time_s - times[key]) / length_s);
  if (sampler.interpolation == AnimationInterpolation::linear) return segment.linear(rotation, value);
  segment.cubic(rotation, length_s, value);
}

std::vector<bool> nodes_moved_by(const PartAnimations& animations, const AnimationClip& clip) {
  std::vector<bool> moved(animations.nodes.size(), false);
  for (const AnimationChannel& channel : clip.channels) {
    if (channel.property != AnimatedProperty::weights) moved[channel.node] = true;
  }
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const int parent = animations.nodes[i].parent;
    if (parent >= 0 && moved[static_cast<std::size_t>(parent)]) moved[i] = true;
  }
  return moved;
}

}  // namespace simvis
