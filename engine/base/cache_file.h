// Cache files that SimVis keeps between runs. A lost or damaged file costs time and causes no error.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace simvis {

/// The folder for SimVis's caches: `wish` if not empty, else $XDG_CACHE_HOME/simvis, else $HOME/.cache/simvis. Empty
/// (no cache on disk) if none of these is set.
std::filesystem::path cache_folder(const std::string& wish);

/// Writes the content under a temporary name and renames the file, so that several threads and processes may write one
/// file at the same time. A folder that cannot be written is no error: then there is no file, or the old one remains.
void write_cache_file(const std::filesystem::path& file, std::string_view content);

/// A 64-bit FNV-1a hash, with which a reader verifies that a file is unchanged.
std::uint64_t cache_checksum(std::string_view content);

}  // namespace simvis
