// The pictures of MJCF textures.
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <optional>

#include <simvis/content_pool.h>
#include <simvis/mesh.h>
#include "import/mjcf/mjcf_element.h"
#include "import/model/import_report.h"

namespace simvis {

/// The picture of a texture of type 2d, or that of the sides of a cube, of which all have the same one here: of a file,
/// or built in as MuJoCo does it. Null, after a warning: it cannot be had. What is not taken over is reported: sides
/// that differ. Random marks stand at other places than in MuJoCo. Throws InputError for wrong numbers.
std::shared_ptr<const Texture> mjcf_picture(const MjcfElement& texture, PictureUse use, ContentPool& pool,
                                            ImportReport& report);

/// The linear colour of a sky box at the horizon; empty: there is none, or one of pictures, which is reported.
std::optional<glm::dvec3> mjcf_background(const MjcfModel& model, ImportReport& report);

}  // namespace simvis
