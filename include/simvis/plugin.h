// Elements, sensors, effects and part formats from a user's own shared library.
#pragma once

#include <filesystem>

namespace simvis {

/// Loads the library for the rest of the program; its registrations make its types known. A library that is loaded
/// already is left as it is.
///
/// Errors     InputError, "FILE: error: ...", with the loader's reason, or when a registration is refused: the name is
///            taken, the table of attributes has a mistake, the plug-in was built for another version, or it registers
///            nothing. Its types are then unknown as before, and the program can go on.
/// Lifetime   call it before a scene that uses the types is loaded.
/// Threading  one thread at a time loads plug-ins, while no scene is being loaded in another.
void load_plugin(const std::filesystem::path& file);

}  // namespace simvis
