// Checks that the numbers of a COLLADA file are consistent. If they are not, Assimp 5.2 reads beyond its arrays: it
// crashes or returns geometry that is not in the file.
#pragma once

#include "scenegraph/language/xml_text.h"

namespace simvis {

/// Throws InputError with the place for an accessor that reaches beyond its array, primitives without exactly one
/// VERTEX input, input offsets that are not small whole numbers, and indices and counts that are not whole numbers.
void check_collada(const XmlText& text);

}  // namespace simvis
