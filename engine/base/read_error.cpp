#include "engine/base/read_error.h"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include <simvis/error.h>
#include "engine/base/opened_path.h"
#include "engine/base/read_scope.h"

namespace simvis {
namespace {

// ENXIO and ENODEV: of sockets and of device nodes without a device. EOVERFLOW and EFBIG: the file is too large.
constexpr int kFaultsOfFiles[] = {ENOENT, ENOTDIR, EISDIR, EACCES, EPERM,     ELOOP, ENAMETOOLONG,
                                  EILSEQ, EINVAL,  ENXIO,  ENODEV, EOVERFLOW, EFBIG};

// For a request, nothing is there outside the folders of its limit.
std::filesystem::file_type type_within_limit(const std::filesystem::path& file, const Folders& limit) {
  const OpenedPath found(file);
  if (found.error() != 0 && !is_fault_of_file(found.error())) {
    throw_read_error(file, "cannot be looked up", found.error());
  }
  if (found.error() != 0 || !lies_in(place_of(file, found.descriptor()), limit)) {
    return std::filesystem::file_type::not_found;
  }
  struct stat status {};
  if (::fstat(found.descriptor(), &status) != 0) throw_read_error(file, "cannot be looked up", errno);
  return S_ISREG(status.st_mode)   ? std::filesystem::file_type::regular
         : S_ISDIR(status.st_mode) ? std::filesystem::file_type::directory
                                   : std::filesystem::file_type::unknown;
}

std::filesystem::file_type type_of(const std::filesystem::path& file) {
  if (const ReadScope* const scope = innermost_read_scope(); scope != nullptr && scope->limit) {
    return type_within_limit(file, *scope->limit);
  }
  std::error_code error;
  const std::filesystem::file_type type = std::filesystem::status(file, error).type();
  if (error && !is_fault_of_file(error.value())) throw_read_error(file, "cannot be looked up", error.value());
  return type;
}

}  // namespace

bool is_fault_of_file(int error) { return std::ranges::find(kFaultsOfFiles, error) != std::end(kFaultsOfFiles); }

void throw_read_error(const std::filesystem::path& file, const std::string& what, int error) {
  const std::string message = file.string() + ": error: " + what + ": " + std::generic_category().message(error);
  if (is_fault_of_file(error)) throw InputError(message);
  throw MachineError(message);
}

void refuse_lfs_pointer(const std::filesystem::path& file, std::string_view text) {
  if (!text.starts_with(kLfsPointerStart)) return;
  throw InputError(
      file.string() +
      ": error: is a pointer of Git LFS, not the file itself, expected the file: `git lfs pull` fetches it");
}

bool is_there(const std::filesystem::path& path) {
  return type_of(path) != std::filesystem::file_type::not_found && type_of(path) != std::filesystem::file_type::none;
}

bool is_input_file(const std::filesystem::path& file) { return type_of(file) == std::filesystem::file_type::regular; }

bool is_input_folder(const std::filesystem::path& folder) {
  return type_of(folder) == std::filesystem::file_type::directory;
}

}  // namespace simvis
