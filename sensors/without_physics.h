// What sensors of forces do where physics moves nothing.
#pragma once

#include "scenegraph/language/attribute_rows.h"

namespace simvis {

/// Sensors that a file of a robot brings have "nothing", because the same file is shown without physics too.
template <typename Desc>
AttributeRow<Desc> without_physics_row(bool Desc::*needs_physics) {
  return row(needs_physics, "without_physics", {{true, "error"}, {false, "nothing"}},
             "error: physics that moves what is measured has to be there; nothing: without it there are no forces");
}

}  // namespace simvis
