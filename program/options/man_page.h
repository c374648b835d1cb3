// The manual page of simvis-run.
#pragma once

#include <string>

namespace simvis {

/// simvis-run(1) for man, from the table of options.
std::string man_page();

}  // namespace simvis
