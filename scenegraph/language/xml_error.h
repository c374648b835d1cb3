// Errors in the form of XML texts.
#pragma once

#include <pugixml.hpp>

#include "scenegraph/language/source_text.h"

namespace simvis {

/// Throws InputError for a text that pugixml refused, with the place that it gives. Names the tag that is not closed.
[[noreturn]] void fail_xml(const SourceText& source, const pugi::xml_parse_result& result);

}  // namespace simvis
