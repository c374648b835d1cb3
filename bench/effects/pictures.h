// What effects look like.
#pragma once

#include <filesystem>

namespace simvis::bench {

/// Writes FOLDER/EFFECT.png for each effect: without it on the left, with it on the right; of cameras what they see, of
/// scanners their hits from above, the scanner at the left edge. Throws MachineError where it cannot.
void write_effect_pictures(const std::filesystem::path& folder);

}  // namespace simvis::bench
