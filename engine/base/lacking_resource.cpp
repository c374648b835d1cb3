#include "engine/base/lacking_resource.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace simvis {

std::string lacking_resource(std::size_t memory_bytes) {
  void* const memory = ::mmap(nullptr, memory_bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) {
    return "less than " + std::to_string(memory_bytes >> 20) + " MiB of memory are left: " + std::strerror(errno);
  }
  ::munmap(memory, memory_bytes);
  const int file = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  if (file < 0) return std::string("no file can be opened: ") + std::strerror(errno);
  ::close(file);
  return {};
}

}  // namespace simvis
