// Elements, sensors and part formats from a user's own shared library.
#pragma once

#include <filesystem>

namespace simvis {

/// Loads the library for the rest of the program; its registrations make its types known. Call it before a scene that
/// uses them is loaded. Throws InputError with the loader's reason.
void load_plugin(const std::filesystem::path& file);

}  // namespace simvis
