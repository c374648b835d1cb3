#include <simvis/version.h>

namespace simvis {

std::string_view version() { return kHeaderVersion; }

}  // namespace simvis
