// A glTF part with animations in a scene, and what the scene's graph becomes at a time.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "simvis/scene_builder.h"
#include "tests/support/parts/gltf_fixture.h"

namespace simvis::test {

/// Adds a clip without channels and returns it.
json& add_clip(GltfBuilder& builder, const std::string& name);

/// Adds a channel, and a sampler of its own, to the clip of that number.
void add_channel(GltfBuilder& builder, int node, const char* path, const char* interpolation, int input, int output,
                 std::size_t clip = 0);

/// A strip that stands on z = 0 at x = 3, 4 wide and 2 high, and bends at z = 1 about the y axis by 0, 45 and 90
/// degrees at 0, 1 and 2 s. Its hinge's vertices follow both joints.
GltfBuilder bending_strip();

/// The part P, in glTF's own axes, played by the element WALK.
class PlayedPart {
 public:
  explicit PlayedPart(const GltfBuilder& builder, const std::string& attributes = "", const std::string& more = "");
  explicit PlayedPart(const std::filesystem::path& file, const std::string& attributes = "");

  /// The draw list at this time.
  const DrawList& at(double time_s);
  /// world_from_mesh of the i-th item.
  glm::dmat4 matrix_at(double time_s, std::size_t item = 0);
  const Mesh& mesh_at(double time_s, std::size_t item = 0);

  BuiltScene& built() { return built_; }
  const FlattenCounters& counters() const { return flattener_->counters(); }
  double duration_s(std::size_t clip = 0);

 private:
  void start(const std::filesystem::path& file, const std::string& attributes, const std::string& more);

  TemporaryFolder folder_;
  BuiltScene built_;
  std::optional<Flattener> flattener_;
};

}  // namespace simvis::test
