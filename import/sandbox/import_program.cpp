#include "import/sandbox/import_program.h"

#include "engine/base/beside_library.h"

namespace simvis {

std::filesystem::path import_program(std::string_view name) { return beside_library(name); }

}  // namespace simvis
