// Reads the XML text of MJCF as MuJoCo does, where it is more lenient than XML.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scenegraph/language/xml_text.h"

namespace simvis {

/// Reads a file up to its end, or to a closing tag behind the root, which closes nothing: TinyXML, the parser of
/// MuJoCo, ends there without a message. That is added to `warnings`, with its place. Throws InputError as
/// XmlText::read().
XmlText read_mjcf_text(const std::filesystem::path& file, std::vector<std::string>& warnings);

}  // namespace simvis
