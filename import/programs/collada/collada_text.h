// Reads COLLADA files of any encoding as UTF-8 text, because Assimp and the checks before it need UTF-8.
#pragma once

#include "import/programs/assimp_file.h"
#include "scenegraph/language/source_text.h"

namespace simvis {

/// UTF-16, UTF-8, and the 8-bit encodings Latin-1 and Windows-1252 where the file declares them, are read as they are.
/// What follows the root element is left out, and bytes that break the file's encoding are read as Windows-1252, each
/// with a warning. Throws InputError if the file cannot be read.
SourceText read_collada_text(AssimpFile& file);

}  // namespace simvis
