// The data of a light in the layout that the shaders read.
#pragma once

#include <glm/glm.hpp>

#include <simvis/draw_list.h>
#include "shaders/interop.h"

namespace simvis {

/// The block of a light with this transform from its frame to the view frame.
shader::LightBlock make_light_block(const Light& light, const glm::dmat4& view_from_light);

}  // namespace simvis
