// Reduces a COLLADA file to the parts that are shown. Assimp 5.2 ends the whole program at some errors in other parts.
#pragma once

#include "scenegraph/language/xml_text.h"

namespace simvis {

struct ColladaShapes {
  bool had_animations = false, had_skins = false;
};

/// Replaces each <skew> by its <matrix>: Assimp 5.2 ends the program at it. Throws InputError with the place for one
/// that is no angle and two axes, or turns the first axis as far as the second. Changes the document.
void replace_skews(XmlText& text);

/// Removes animations, cameras, lights, physics and the extra data of other programs. A skinned or morphed mesh is
/// replaced by its base mesh. Changes the document.
ColladaShapes reduce_to_shapes(XmlText& text);

}  // namespace simvis
