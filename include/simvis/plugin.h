// Plug-ins: elements, sensors, effects and part formats from a user's own shared library.
#pragma once

#include <filesystem>

#include <simvis/export.h>

namespace simvis {

/// Loads a shared library for the rest of the program; its registrations make its types known. A library that is
/// already loaded is left as it is. A helper program loads the library first, so static initialisers run there too.
///
/// Errors    InputError, "FILE: error: ...", with the loader's reason, if a static initialiser throws, crashes or takes
///           longer than 60 s, or if a registration is refused: the name is taken, the table of attributes has a
///           mistake, the plug-in was built for another version, or it registers nothing. Its types are then unknown as
///           before, and the program can continue. MachineError if the helper program cannot be started.
/// Lifetime  must be called before a scene that uses the types is loaded.
/// Threads   one thread at a time loads plug-ins; other threads may load and run simulations meanwhile.
SIMVIS_API void load_plugin(const std::filesystem::path& file);

}  // namespace simvis
