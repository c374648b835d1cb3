#include "scenegraph/import/sandbox/import_program.h"

#include <dlfcn.h>

#include <system_error>

namespace simvis {

std::filesystem::path import_program(std::string_view name) {
  static const char kInLibrary = 0;
  Dl_info library{};
  std::filesystem::path file;
  if (::dladdr(&kInLibrary, &library) != 0) file = library.dli_fname;
  std::error_code error;
  const std::filesystem::path real = std::filesystem::canonical(file, error);
  return (error ? file : real).parent_path() / "simvis" / name;
}

}  // namespace simvis
