// The thread sanitizer tells accesses by their address. Host and clients of one process map the same object at
// different addresses, where it would see no race; linked with --wrap=mmap,--wrap=munmap, this gives them one address.
#include <sys/mman.h>
#include <sys/stat.h>

#include <map>
#include <mutex>

extern "C" {
void* __real_mmap(void* address, std::size_t size, int protection, int flags, int file, off_t offset);
int __real_munmap(void* address, std::size_t size);
void* __wrap_mmap(void* address, std::size_t size, int protection, int flags, int file, off_t offset);
int __wrap_munmap(void* address, std::size_t size);
}

namespace {

struct Mapping {
  void* memory = nullptr;
  std::size_t size = 0;
  int users = 0;
};
std::mutex mutex;
std::map<ino_t, Mapping> mappings;

}  // namespace

void* __wrap_mmap(void* address, std::size_t size, int protection, int flags, int file, off_t offset) {
  struct stat named {};
  if (file < 0 || (flags & MAP_SHARED) == 0 || ::fstat(file, &named) != 0) {
    return __real_mmap(address, size, protection, flags, file, offset);
  }
  const std::lock_guard lock(mutex);
  Mapping& mapping = mappings[named.st_ino];
  if (mapping.users == 0) mapping = {__real_mmap(address, size, protection, flags, file, offset), size, 0};
  if (size > mapping.size) return MAP_FAILED;
  ++mapping.users;
  return mapping.memory;
}

int __wrap_munmap(void* address, std::size_t size) {
  const std::lock_guard lock(mutex);
  for (auto each = mappings.begin(); each != mappings.end(); ++each) {
    if (each->second.memory != address) continue;
    if (--each->second.users > 0) return 0;
    mappings.erase(each);
    break;
  }
  return __real_munmap(address, size);
}
