#include "import/gltf/gltf_animations.h"

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "import/gltf/gltf_accessors.h"

namespace simvis {
namespace {

constexpr unsigned kUnitFormats = kGltfF32 | kGltfI8n | kGltfU8n | kGltfI16n | kGltfU16n;
constexpr GltfUse kTimes{"times of an animation", kGltfScalar, kGltfF32};
// In the order of AnimatedProperty.
constexpr GltfUse kValues[] = {{"translations", kGltfVec3, kGltfF32},
                               {"rotations", kGltfVec4, kUnitFormats},
                               {"scales", kGltfVec3, kGltfF32},
                               {"morph weights", kGltfScalar, kUnitFormats}};
constexpr const char* kPaths[] = {"translation", "rotation", "scale", "weights"};
constexpr const char* kInterpolations[] = {"STEP", "LINEAR", "CUBICSPLINE"};

using Floats = std::shared_ptr<const std::vector<float>>;

const GltfUse& use_of(AnimatedProperty property) { return kValues[static_cast<std::size_t>(property)]; }

class MotionReader {
 public:
  explicit MotionReader(GltfDocument& document) : document_(document) {}

  AnimationClip read_clip(std::size_t index) {
    const GltfAnimation& source = document_.animations[index];
    const std::string place = "animations/" + std::to_string(index);
    AnimationClip clip;
    clip.name = source.name;
    std::set<std::pair<int, AnimatedProperty>> driven;
    std::map<std::pair<std::size_t, AnimatedProperty>, std::size_t> known;  // samplers of the clip
    for (std::size_t c = 0; c < source.channels.size(); ++c) {
      const GltfAnimation::Channel& channel = source.channels[c];
      const std::string channel_place = place + "/channels/" + std::to_string(c);
      if (channel.sampler >= source.samplers.size()) {
        document_.fail(channel_place + "/sampler is " + std::to_string(channel.sampler) + ", but the animation has " +
                       std::to_string(source.samplers.size()) + " samplers");
      }
      if (channel.node < 0 || channel.path == "pointer") {  // extensions define such channels
        document_.warn("animation channels that are not for a node are left out");
        continue;
      }
      const AnimatedProperty property = read_target(channel, channel_place);
      if (!driven.emplace(channel.node, property).second) {
        document_.fail(channel_place + " changes the " + channel.path + " of nodes/" + std::to_string(channel.node) +
                       ", as a channel before it does; expected one");
      }
      const auto [sampler, is_new] = known.try_emplace({channel.sampler, property}, clip.samplers.size());
      if (is_new) {
        clip.samplers.push_back(read_sampler(source.samplers[channel.sampler],
                                             place + "/samplers/" + std::to_string(channel.sampler), property,
                                             width_of(property, channel.node)));
      }
      check_width(clip.samplers[sampler->second], property, channel, channel_place);
      if (clip.samplers[sampler->second].times_s == nullptr) continue;
      clip.channels.push_back({static_cast<std::size_t>(channel.node), property, sampler->second});
      clip.duration_s = std::max(clip.duration_s, static_cast<double>(clip.samplers[sampler->second].times_s->back()));
    }
    return clip;
  }

 private:
  AnimatedProperty read_target(const GltfAnimation::Channel& channel, const std::string& place) const {
    const auto* const path = std::ranges::find(kPaths, channel.path);
    if (path == std::end(kPaths)) {
      document_.fail(place + "/target/path is \"" + channel.path +
                     "\"; expected translation, rotation, scale or weights");
    }
    const auto property = static_cast<AnimatedProperty>(path - std::begin(kPaths));
    const std::string node = "nodes/" + std::to_string(channel.node);
    if (property == AnimatedProperty::weights) {
      if (targets_of(channel.node) == 0) document_.fail(place + " changes the weights of " + node + ", which has none");
    } else if (!document_.model.nodes[static_cast<std::size_t>(channel.node)].matrix.empty()) {
      document_.fail(place + " moves " + node + ", which has a matrix; expected translation, rotation and scale");
    }
    return property;
  }

  // Returns the number of morph targets that every primitive of the node's mesh has.
  std::size_t targets_of(int node) const {
    const int mesh = document_.model.nodes[static_cast<std::size_t>(node)].mesh;
    if (mesh < 0) return 0;
    const auto& primitives = document_.model.meshes[static_cast<std::size_t>(mesh)].primitives;
    if (primitives.empty()) return 0;
    for (const tinygltf::Primitive& primitive : primitives) {
      if (primitive.targets.size() == primitives[0].targets.size()) continue;
      document_.fail("meshes/" + std::to_string(mesh) + " has primitives with different numbers of morph targets");
    }
    return primitives[0].targets.size();
  }

  std::size_t width_of(AnimatedProperty property, int node) const {
    if (property == AnimatedProperty::weights) return targets_of(node);
    return property == AnimatedProperty::rotation ? 4 : 3;
  }

  // Several channels may use one sampler, and a file may do so for nodes with different numbers of morph targets.
  void check_width(const AnimationSampler& sampler, AnimatedProperty property, const GltfAnimation::Channel& channel,
                   const std::string& place) const {
    const std::size_t width = width_of(property, channel.node);
    if (width == sampler.width) return;
    document_.fail(place + " has a sampler of " + std::to_string(sampler.width) + " weights for nodes/" +
                   std::to_string(channel.node) + ", which has " + std::to_string(width));
  }

  // Returns a sampler without times if the file holds no data for it.
  AnimationSampler read_sampler(const GltfAnimation::Sampler& source, const std::string& place,
                                AnimatedProperty property, std::size_t width) {
    AnimationSampler sampler;
    const auto* const interpolation = std::ranges::find(kInterpolations, source.interpolation);
    if (interpolation == std::end(kInterpolations)) {
      document_.fail(place + "/interpolation is \"" + source.interpolation +
                     "\"; expected STEP, LINEAR or CUBICSPLINE");
    }
    sampler.interpolation = static_cast<AnimationInterpolation>(interpolation - std::begin(kInterpolations));
    sampler.width = width;
    check_use(document_, source.input, kTimes);
    check_use(document_, source.output, use_of(property));
    check_counts(source, sampler, place, property);
    if (has_data(document_, source.input)) sampler.times_s = read_times(source.input, place);
    if (has_data(document_, source.output)) {
      sampler.values = read_once(source.output, use_of(property));
      if (property == AnimatedProperty::rotation) check_rotations(sampler, source.output, place);
    }
    if (sampler.times_s == nullptr || sampler.values == nullptr) {
      document_.warn("animation channels whose accessors hold no data are left out");
      sampler.times_s = nullptr;
    }
    return sampler;
  }

  void check_counts(const GltfAnimation::Sampler& source, const AnimationSampler& sampler, const std::string& place,
                    AnimatedProperty property) const {
    const std::size_t times = count_of(source.input), values = count_of(source.output);
    const bool cubic = sampler.interpolation == AnimationInterpolation::cubic_spline;
    const std::size_t expected = times * (cubic ? 3 : 1) * (property == AnimatedProperty::weights ? sampler.width : 1);
    if (values != expected) {
      document_.fail(place + " has " + std::to_string(values) + " output values for " + std::to_string(times) +
                     " times; expected " + std::to_string(expected));
    }
    if (cubic && times < 2) document_.fail(place + " has one time; expected at least 2 for CUBICSPLINE");
  }

  std::size_t count_of(int accessor) const {
    return document_.model.accessors[static_cast<std::size_t>(accessor)].count;
  }

  // Many samplers have the same times, so the values of an accessor are stored once.
  Floats read_once(int accessor, const GltfUse& use) {
    Floats& floats = floats_[accessor];
    if (floats == nullptr) {
      floats = std::make_shared<const std::vector<float>>(read_floats(document_, accessor, use).values);
    }
    return floats;
  }

  Floats read_times(int accessor, const std::string& place) {
    const bool is_new = floats_.find(accessor) == floats_.end();
    Floats times = read_once(accessor, kTimes);
    for (std::size_t k = 0; is_new && k < times->size(); ++k) {
      const float before = k == 0 ? -0.0f : (*times)[k - 1], now = (*times)[k];
      if (k == 0 ? now >= 0 : now > before) continue;
      document_.fail(place + "/input: accessors/" + std::to_string(accessor) + " has the time " + std::to_string(now) +
                     (k == 0 ? "" : " after " + std::to_string(before)) + " in element " + std::to_string(k) +
                     "; expected times that ascend from 0");
    }
    return times;
  }

  void check_rotations(const AnimationSampler& sampler, int accessor, const std::string& place) {
    const bool cubic = sampler.interpolation == AnimationInterpolation::cubic_spline;
    if (!checked_rotations_.emplace(accessor, cubic).second) return;
    const std::vector<float>& v = *sampler.values;
    for (std::size_t i = 0; i + 3 < v.size(); i += 4) {
      if (cubic && i / 4 % 3 != 1) continue;  // a tangent
      if (unit_quaternion({v[i], v[i + 1], v[i + 2], v[i + 3]})) continue;
      document_.fail(place + "/output: accessors/" + std::to_string(accessor) + " has in element " +
                     std::to_string(i / 4) + " a rotation that is not a unit quaternion");
    }
  }

  GltfDocument& document_;
  std::map<int, Floats> floats_;
  std::set<std::pair<int, bool>> checked_rotations_;
};

}  // namespace

GltfMotion read_motion(GltfDocument& document, const GltfHierarchy& hierarchy) {
  const std::size_t nodes = document.model.nodes.size();
  GltfMotion motion{.clips = {},
                    .is_moved = std::vector<bool>(nodes, false),
                    .is_carried = {},
                    .moving_weights = std::vector<std::size_t>(nodes, 0)};
  MotionReader reader(document);
  for (std::size_t a = 0; a < document.animations.size(); ++a) motion.clips.push_back(reader.read_clip(a));
  for (const AnimationClip& clip : motion.clips) {
    for (const AnimationChannel& channel : clip.channels) {
      if (channel.property == AnimatedProperty::weights) {
        motion.moving_weights[channel.node] = clip.samplers[channel.sampler].width;
      } else {
        motion.is_moved[channel.node] = true;
      }
    }
  }
  motion.is_carried = motion.is_moved;
  for (const int node : hierarchy.order) {
    const auto index = static_cast<std::size_t>(node);
    const int parent = hierarchy.parents[index];
    if (parent >= 0 && motion.is_carried[static_cast<std::size_t>(parent)]) motion.is_carried[index] = true;
  }
  return motion;
}

bool moves_skin(const GltfDocument& document, const GltfMotion& motion, int skin) {
  return std::ranges::any_of(document.model.skins[static_cast<std::size_t>(skin)].joints,
                             [&](int joint) { return bool{motion.is_carried[static_cast<std::size_t>(joint)]}; });
}

const std::vector<double>& rest_weights(const GltfDocument& document, int node) {
  const tinygltf::Node& source = document.model.nodes[static_cast<std::size_t>(node)];
  return source.weights.empty() ? document.model.meshes[static_cast<std::size_t>(source.mesh)].weights : source.weights;
}

}  // namespace simvis
