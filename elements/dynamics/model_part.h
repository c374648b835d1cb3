// The part whose file says what an element of physics moves.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include <simvis/element.h>
#include <simvis/part_importer.h>

namespace simvis {

inline constexpr std::string_view kUrdfEndings[] = {".urdf", ".xacro"}, kSdfEndings[] = {".sdf", ".world"};

/// A part, its file as the importer reads it, and what stands in front of the file's names in the scene.
struct ModelPart {
  ImportRequest request;
  std::string prefix;
  bool is_sdf = false;
};

/// The part that an attribute of the command names. Throws InputError at the attribute if there is no such part, or it
/// is not of such a file ("SDF file"), and at the part's own attributes if it is scaled.
ModelPart read_model_part(const ElementContext& context, const CommandAttribute& part, bool takes_urdf);

}  // namespace simvis
