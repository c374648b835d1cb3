// Scripts by which shells complete the command line of simvis-run.
#pragma once

#include <string>
#include <string_view>

namespace simvis {

/// The script for `shell`, one of the words of --completion, from the table of options: names of options, values that
/// are words, files by their ending, folders. Types and formats are those that are registered when it is called.
std::string completion_script(std::string_view shell);

}  // namespace simvis
