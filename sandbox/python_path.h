// Where the Python programs of helpers look for modules.
#pragma once

#include <string>

namespace simvis {

/// The absolute folders of PYTHONPATH, separated by colons. Python takes an empty entry for the current folder, which
/// may be that of a stranger's part.
std::string python_path();

}  // namespace simvis
