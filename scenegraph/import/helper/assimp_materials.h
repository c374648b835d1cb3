// Materials of a mesh file.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <utility>

#include <simvis/mesh.h>
#include "scenegraph/import/helper/assimp_file.h"
#include "scenegraph/import/sandbox/imported_scene.h"

namespace simvis {

/// Adds the materials that are asked for to the scene. Diffuse colour, opacity, emission and the diffuse picture are
/// taken; colours are read as sRGB, which is how programs that show these formats have always treated them. Every
/// material is double-sided: the formats do not say which side of a face is the outside, and files with faces turned
/// over are common.
class AssimpMaterials {
 public:
  AssimpMaterials(AssimpFile& file, ImportedScene& scene) : file_(file), scene_(scene) {}

  /// Surfaces are shaded; lines and points without normals are shown as if unlit.
  /// The number in the scene of a material of the file. Its picture is named there, not read.
  /// Throws InputError: colours that are negative or not finite, an opacity outside 0 to 1.
  std::uint32_t get(unsigned material, bool shaded);

 private:
  ImportedMaterial convert(const aiMaterial& source);
  void set_picture(const aiMaterial& source, ImportedMaterial& imported);
  std::uint32_t picture(const std::string& name, const Sampler& sampler);

  AssimpFile& file_;
  ImportedScene& scene_;
  std::map<std::pair<unsigned, bool>, std::uint32_t> numbers_;
  std::map<std::tuple<std::string, Wrap, Wrap>, std::uint32_t> pictures_;
};

}  // namespace simvis
