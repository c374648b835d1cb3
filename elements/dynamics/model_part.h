// The part whose file says what an element of physics moves.
#pragma once

#include <string>

#include <simvis/element.h>
#include "import/model/model_description.h"

namespace simvis {

/// A part of a robot or a world, and what stands in front of the file's names in the scene.
struct ModelPart {
  ModelSource& source;  ///< lives as long as the part
  std::string prefix;
};

/// The part that an attribute of the command names; `use` is what it is for, such as "a robot". Throws InputError at
/// the attribute if there is no such part or its file has no links, and at the part's own attributes if it is scaled.
ModelPart find_model_part(const ElementContext& context, const CommandAttribute& part, const std::string& use);

}  // namespace simvis
