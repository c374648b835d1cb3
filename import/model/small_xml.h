// Small XML files beside models, which need not be there: package.xml, model.config.
#pragma once

#include <filesystem>
#include <pugixml.hpp>

namespace simvis {

/// Returns whether the file is there and is XML. Throws MachineError if the machine cannot read it (read_error.h).
bool load_if_there(const std::filesystem::path& file, pugi::xml_document& document);

}  // namespace simvis
