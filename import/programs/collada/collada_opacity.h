// Brings the opacity of COLLADA effects to what their exporters meant.
#pragma once

#include "import/programs/assimp_file.h"
#include "scenegraph/language/xml_text.h"

namespace simvis {

/// Old exporters write <transparency> 0 for opaque surfaces. Two readings differ from the format's text, each with a
/// warning that has the place; every other opacity is left to Assimp, which follows the text:
/// - Exporters that mean opaque="RGB_ZERO" where they name no mode are read so (partial transparency is inverted).
/// - An effect that is wholly transparent then, or whose opacity is not within 0 to 1, is opaque.
/// Changes the document.
void set_collada_opacities(XmlText& text, AssimpFile& file);

}  // namespace simvis
