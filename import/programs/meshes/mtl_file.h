// Reads the material files of OBJ.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <map>
#include <string>

#include <simvis/draw_list.h>
#include "import/programs/part_source.h"

namespace simvis {

/// What is used of a material.
struct MtlMaterial {
  glm::vec3 diffuse{0.6f}, emissive{0};  ///< sRGB; a material that no file describes is of this grey, as in Assimp
  double opacity = 1;
  std::string picture{}, cut_out{};  ///< names of files: of the colour (map_Kd), of the opacity (map_d); empty: none
  Wrap wrap = Wrap::repeat;          ///< of `picture`
};

using MtlMaterials = std::map<std::string, MtlMaterial, std::less<>>;

/// Adds the materials of the file by their names; one that is there already is changed. MeshLab writes the opacity as
/// `Tr`; of `d` and `Tr` that contradict each other `d` counts; a material that is wholly transparent is opaque; each
/// with a warning that has the place. Throws InputError with the place for a property before the first material, a
/// colour that is negative or not finite, an opacity outside 0 to 1, and a word in place of a number.
void read_mtl(PartSource& source, const std::filesystem::path& mtl, MtlMaterials& materials);

}  // namespace simvis
