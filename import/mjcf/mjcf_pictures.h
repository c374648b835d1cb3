// The pictures of MJCF textures.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>

#include <simvis/content_pool.h>
#include <simvis/mesh.h>
#include "import/mjcf/mjcf_element.h"
#include "import/model/import_report.h"

namespace simvis {

/// The number of pictures for the sides of a cube: one for all, or one for each, and none of a texture of type 2d.
enum class CubeSides : std::uint8_t { none = 0, equal = 1, own = 6 };

struct MjcfPicture {
  std::shared_ptr<const Texture> picture;  ///< null, after a warning: it cannot be had
  CubeSides sides = CubeSides::none;       ///< own: one square below the other, towards +x, -x, +y, -y, +z and -z
};

/// The picture of a texture: of files, or built in as MuJoCo does it. Random marks stand at other places than in
/// MuJoCo. Throws InputError for wrong numbers.
MjcfPicture mjcf_picture(const MjcfElement& texture, PictureUse use, ContentPool& pool, ImportReport& report);

/// The linear colour of a sky box at the horizon; empty: there is none, or one of pictures, which is reported.
std::optional<glm::dvec3> mjcf_background(const MjcfModel& model, ImportReport& report);

}  // namespace simvis
