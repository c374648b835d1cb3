#include "import/programs/file_access.h"

#include <fcntl.h>
#include <linux/landlock.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>

#include <simvis/error.h>

namespace simvis {
namespace {

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

// The rights of the first version of Landlock: reading, and all that makes or changes files.
constexpr std::uint64_t kReads = LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR;
constexpr std::uint64_t kHandled =
    kReads | LANDLOCK_ACCESS_FS_EXECUTE | LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_REMOVE_DIR |
    LANDLOCK_ACCESS_FS_REMOVE_FILE | LANDLOCK_ACCESS_FS_MAKE_CHAR | LANDLOCK_ACCESS_FS_MAKE_DIR |
    LANDLOCK_ACCESS_FS_MAKE_REG | LANDLOCK_ACCESS_FS_MAKE_SOCK | LANDLOCK_ACCESS_FS_MAKE_FIFO |
    LANDLOCK_ACCESS_FS_MAKE_BLOCK | LANDLOCK_ACCESS_FS_MAKE_SYM;

void allow_reading(int rules, const std::filesystem::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_PATH | O_CLOEXEC);
  if (descriptor < 0) return;
  for (const std::uint64_t rights : {kReads, std::uint64_t{LANDLOCK_ACCESS_FS_READ_FILE}}) {  // of a folder, of a file
    landlock_path_beneath_attr rule{.allowed_access = rights, .parent_fd = descriptor};
    if (::syscall(__NR_landlock_add_rule, rules, LANDLOCK_RULE_PATH_BENEATH, &rule, 0) == 0) break;
  }
  ::close(descriptor);
}

#endif

}  // namespace

void restrict_files([[maybe_unused]] const Folders& folders) {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  const landlock_ruleset_attr handled{.handled_access_fs = kHandled};
  const auto rules = static_cast<int>(::syscall(__NR_landlock_create_ruleset, &handled, sizeof handled, 0));
  // EPERM: a filter of the container refuses the call.
  if (rules < 0 && (errno == ENOSYS || errno == EOPNOTSUPP || errno == EPERM)) return;
  if (rules < 0) throw MachineError(std::string("cannot restrict which files are read: ") + std::strerror(errno));
  for (const std::filesystem::path& folder : folders) allow_reading(rules, folder);
  const bool is_restricted =
      ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && ::syscall(__NR_landlock_restrict_self, rules, 0) == 0;
  ::close(rules);
  if (!is_restricted) throw MachineError("cannot restrict which files are read");
#endif
}

}  // namespace simvis
