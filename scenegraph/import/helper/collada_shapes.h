// Reduces a COLLADA file to the parts that are shown. Assimp 5.2 ends the whole program at some errors in other parts.
#pragma once

#include <string>

#include "scenegraph/language/xml_text.h"

namespace simvis {

struct ColladaShapes {
  std::string xml;
  bool had_animations = false, had_skins = false;
};

/// Removes animations, cameras, lights, physics and the extra data of other programs. A skinned or morphed mesh is
/// replaced by its base mesh.
ColladaShapes collada_shapes(const XmlText& text);

}  // namespace simvis
