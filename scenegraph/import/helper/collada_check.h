// Whether a COLLADA file's numbers fit together. Assimp 5.2 reads beyond its arrays where they do not: it crashes, or
// gives a geometry that nobody wrote.
#pragma once

#include "scenegraph/language/xml_text.h"

namespace simvis {

/// Throws InputError with the place: an accessor that reaches beyond its array, primitives without exactly one input
/// VERTEX, offsets of inputs that are no small whole numbers, indices and counts that are no whole numbers.
void check_collada(const XmlText& text);

}  // namespace simvis
