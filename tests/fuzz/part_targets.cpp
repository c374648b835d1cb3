// Part files that are read in the process.
#include <cmath>
#include <string>

#include <simvis/error.h>
#include <simvis/part_importer.h>
#include "engine/base/assert.h"
#include "engine/draw/splat_cloud.h"
#include "import/mesh/height_picture.h"
#include "import/model/model_description.h"
#include "import/usd/usd_answer.h"
#include "scenegraph/flattener.h"
#include "scenegraph/language/command_reader.h"
#include "tests/fuzz/fuzz_target.h"

namespace simvis::fuzz {
namespace {

// The guarantees of Mesh must hold for everything that is loaded.
void check_meshes(const DrawList& list) {
  for (const auto& mesh : list.meshes) {
    SIMVIS_ASSERT(mesh->attributes.size() == mesh->positions.size());
    for (const std::uint32_t index : mesh->indices) SIMVIS_ASSERT(index < mesh->positions.size());
    if (mesh->splats) {
      const SplatCloud& cloud = *mesh->splats;
      SIMVIS_ASSERT(cloud.harmonics.size() == cloud.splats.size() * harmonics_count(cloud.degree));
    }
    for (const glm::vec3& p : mesh->positions) {
      SIMVIS_ASSERT(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
    }
  }
}

// Flattens a part, and reads what it says for physics.
void use_part(const PartContent& content, const std::filesystem::path& file, ContentPool& pool) {
  for (const std::string& command : content.commands) {
    try {
      parse_carried_commands(command, file.string(), file.parent_path());
    } catch (const InputError&) {
      // A part may carry what is refused.
    }
  }
  const auto group = std::make_shared<Group>();
  group->add(content.root);
  Flattener flattener(group);
  check_meshes(flattener.update());
  if (content.model != nullptr) content.model->description(pool);
}

void read_part_file(const std::filesystem::path& file) {
  ContentPool pool;
  use_part(find_part_importer(file)({.file = file}, pool), file, pool);
}

void read_gltf(Input input) {
  const bool binary = text_of(input).starts_with("glTF");
  read_part_file(input_file(binary ? "part.glb" : "part.gltf", input));
}
void read_urdf(Input input) { read_part_file(input_file("part.urdf", input)); }
void read_sdf(Input input) { read_part_file(input_file("part.sdf", input)); }
void read_mjcf(Input input) { read_part_file(input_file("part.xml", input)); }

// What the program in Python answers, which reads stages itself.
void read_usd(Input input) {
  const std::filesystem::path file = input_folder() / "part.usda";
  ContentPool pool;
  use_part(read_usd_answer(input, {.file = file}, pool), file, pool);
}

// A map and its picture: the text ends at the first zero.
void read_map(Input input) {
  const std::string_view all = text_of(input);
  const std::size_t end = std::min(all.find('\0'), all.size());
  input_file("map.png", input.subspan(std::min(end + 1, all.size())));
  read_part_file(input_file("part.yaml", input.first(end)));
}

void read_octomap(Input input) { read_part_file(input_file("part.bt", input)); }
void read_voxels(Input input) { read_part_file(input_file("part.npz", input)); }

void read_heights(Input input) {
  const bool exr = text_of(input).starts_with("\x76\x2f\x31\x01");
  read_height_picture(input_file(exr ? "heights.exr" : "heights.png", input));
}

const TargetRegistration kGltf("gltf", read_gltf);
const TargetRegistration kUrdf("urdf", read_urdf);
const TargetRegistration kSdf("sdf", read_sdf);
const TargetRegistration kMjcf("mjcf", read_mjcf);
const TargetRegistration kUsd("usd", read_usd);
const TargetRegistration kMap("map", read_map);
const TargetRegistration kOctomap("octomap", read_octomap);
const TargetRegistration kVoxels("voxels", read_voxels);
const TargetRegistration kHeights("heights", read_heights);

}  // namespace
}  // namespace simvis::fuzz
