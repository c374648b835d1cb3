#include "engine/base/cache_file.h"

#include <cstdlib>
#include <fstream>
#include <system_error>

#include "engine/base/fnv1a.h"
#include "engine/base/temporary_name.h"

namespace simvis {

std::filesystem::path cache_folder(const std::string& wish) {
  if (!wish.empty()) return wish;
  if (const char* xdg = std::getenv("XDG_CACHE_HOME"); xdg && *xdg) return std::filesystem::path(xdg) / "simvis";
  if (const char* home = std::getenv("HOME"); home && *home) return std::filesystem::path(home) / ".cache" / "simvis";
  return {};
}

void write_cache_file(const std::filesystem::path& file, std::string_view content) {
  std::error_code failure;
  std::filesystem::create_directories(file.parent_path(), failure);
  const std::filesystem::path temporary = file.string() + "." + temporary_name();
  std::ofstream out(temporary, std::ios::binary);
  out.write(content.data(), static_cast<std::streamsize>(content.size()));
  out.close();
  if (out) std::filesystem::rename(temporary, file, failure);
  if (!out || failure) std::filesystem::remove(temporary, failure);
}

std::uint64_t cache_checksum(std::string_view content) { return fnv1a(content); }

}  // namespace simvis
