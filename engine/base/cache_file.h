// Files that SimVis keeps between runs to be quicker. They can be lost or broken at any time, and nothing is wrong
// then.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace simvis {

/// Folder for SimVis's caches: `wish` if not empty, else $XDG_CACHE_HOME/simvis, else $HOME/.cache/simvis; empty (no
/// cache on disk) when none of them is known.
std::filesystem::path cache_folder(const std::string& wish);

/// First under another name, then renamed: several threads and processes may write one file at once. A folder that
/// cannot be written is no error: there is no file then, or the old one.
void write_cache_file(const std::filesystem::path& file, std::string_view content);

/// A 64-bit FNV-1a hash, by which a reader knows that a file is as it was written.
std::uint64_t cache_checksum(std::string_view content);

}  // namespace simvis
