// Resolves which texture coordinates the textures of a COLLADA file use.
#pragma once

#include "import/programs/assimp_file.h"
#include "scenegraph/language/xml_text.h"

namespace simvis {

/// Numbers the sets of each primitive from 0 without gaps, as Assimp stores them, and writes to each <texture> the
/// number of its set in place of the name that <bind_vertex_input> binds. Assimp 5.2 does not always find that binding;
/// it then takes the first digits of the name, so that "UR20_base" is set 20. A texture whose name is not bound uses
/// the set that its name ends with, or the first set, with a warning if the file has several. Controllers must have
/// been replaced by their meshes. Changes the document.
void set_collada_uv_sets(XmlText& text, AssimpFile& file);

}  // namespace simvis
