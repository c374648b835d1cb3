// A COLLADA file cut down to what is shown of it: Assimp 5.2 stops the whole program at some faults of what is not.
#pragma once

#include <string>

#include "scenegraph/language/xml_text.h"

namespace simvis {

struct ColladaShapes {
  std::string xml;
  bool had_animations = false, had_skins = false;
};

/// Animations, cameras, lights, physics and the notes of other programs are left out; a skinned or morphed mesh becomes
/// the plain one beneath it.
ColladaShapes collada_shapes(const XmlText& text);

}  // namespace simvis
