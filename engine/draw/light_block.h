// A light as the shaders read it.
#pragma once

#include <glm/glm.hpp>

#include <simvis/draw_list.h>
#include "shaders/interop.h"

namespace simvis {

/// Of a light whose frame is seen here.
shader::LightBlock make_light_block(const Light& light, const glm::dmat4& view_from_light);

}  // namespace simvis
