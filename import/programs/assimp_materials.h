// Converts the materials of a mesh file.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <utility>

#include <simvis/mesh.h>
#include "import/programs/assimp_file.h"
#include "import/sandbox/imported_scene.h"

namespace simvis {

/// Adds the requested materials to the scene. Diffuse colour, opacity, emission and the diffuse picture are used.
/// Colours are read as sRGB, as other programs that show these formats do. Materials are double-sided, because the
/// formats do not say which side of a face is the outside, and files with inverted faces are common.
class AssimpMaterials {
 public:
  AssimpMaterials(AssimpFile& file, ImportedScene& scene) : file_(file), scene_(scene) {}

  /// Returns the number in the scene of the file's material `material`. The scene names the picture but does not hold
  /// it. `shaded` is true for surfaces; lines and points without normals are shown as unlit. `one_sided` is for faces
  /// that lie back to back, see back_to_back.h.
  /// Throws InputError for colours that are negative or not finite, and for an opacity outside 0 to 1.
  std::uint32_t get(unsigned material, bool shaded, bool one_sided = false);

 private:
  ImportedMaterial convert(const aiMaterial& source);
  void set_picture(const aiMaterial& source, ImportedMaterial& imported);
  std::uint32_t picture(const std::string& name, const Sampler& sampler);

  AssimpFile& file_;
  ImportedScene& scene_;
  std::map<std::tuple<unsigned, bool, bool>, std::uint32_t> numbers_;
  std::map<std::tuple<std::string, Wrap, Wrap>, std::uint32_t> pictures_;
};

}  // namespace simvis
