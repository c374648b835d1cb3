// References of COLLADA that lead nowhere. At each of them, Assimp refuses the file.
#pragma once

#include "import/programs/part_source.h"
#include "scenegraph/language/xml_text.h"

namespace simvis {

/// Adds the "#" that a reference lacks, if the file has what it names. Leaves out, with a warning for each kind,
/// instances of nodes and geometries that are not in the file; and normals, texture coordinates and colours whose
/// source is not in the file, has no array, or has fewer values than the faces name. The positions of vertices must be
/// there: throws InputError with the place of the reference. Changes the document.
void repair_collada_references(XmlText& text, PartSource& file);

}  // namespace simvis
