#include "engine/base/beside_library.h"

#include <dlfcn.h>

#include <system_error>

namespace simvis {

std::filesystem::path beside_library(std::string_view name) {
  static const char kInLibrary = 0;
  Dl_info library{};
  std::filesystem::path file;
  if (::dladdr(&kInLibrary, &library) != 0) file = library.dli_fname;
  std::error_code error;
  const std::filesystem::path real = std::filesystem::canonical(file, error);
  const std::filesystem::path folder = (error ? file : real).parent_path();
  const std::filesystem::path beside_library = folder / "simvis" / name;
  // A program with the library's objects linked in lies in a folder beside the folder of the libraries.
  const std::filesystem::path beside_program = folder.parent_path() / "lib" / "simvis" / name;
  return !std::filesystem::exists(beside_library, error) && std::filesystem::exists(beside_program, error)
             ? beside_program
             : beside_library;
}

}  // namespace simvis
