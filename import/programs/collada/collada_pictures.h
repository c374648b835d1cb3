// Removes textures of COLLADA files whose image names no file. Assimp 5.2 refuses such files.
#pragma once

#include "import/programs/assimp_file.h"
#include "scenegraph/language/xml_text.h"

namespace simvis {

/// A texture without a file is replaced by white, with a warning that has the image's place. Changes the document.
void remove_collada_textures_without_file(XmlText& text, AssimpFile& file);

}  // namespace simvis
