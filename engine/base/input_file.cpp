#include "engine/base/input_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <string>

#include <simvis/error.h>
#include "engine/base/input_log.h"
#include "engine/base/opened_path.h"
#include "engine/base/read_error.h"
#include "engine/base/read_fence.h"

namespace simvis {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what) {
  throw InputError(file.string() + ": error: " + what);
}

}  // namespace

// The delegated constructor has ended when this body begins, so the destructor closes the file if the body throws.
InputFile::InputFile(const std::filesystem::path& file) : InputFile(file, NotOpened{}) {
  require_readable(file);
  const OpenedPath found(file);
  if (found.error() == ENOENT || found.error() == ENOTDIR) fail(file, "there is no such file");
  if (found.error() != 0) throw_read_error(file, "cannot be read", found.error());
  // The name may lead elsewhere since it was checked.
  if (!is_readable(file, found.descriptor())) refuse_to_read(file);
  struct stat status {};
  if (::fstat(found.descriptor(), &status) != 0) throw_read_error(file, "cannot be read", errno);
  // A pipe or a device may never end.
  if (!S_ISREG(status.st_mode)) fail(file, "is not a regular file");
  size_ = static_cast<std::size_t>(status.st_size);
  descriptor_ = ::open(("/proc/self/fd/" + std::to_string(found.descriptor())).c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor_ < 0) throw_read_error(file, "cannot be opened", errno);
  note_input(file);
  std::array<std::uint8_t, kLfsPointerStart.size()> start{};
  if (size_ >= start.size() && size_ <= kLargestLfsPointer) {
    read_into(start, 0);
    refuse_lfs_pointer(file, {reinterpret_cast<const char*>(start.data()), start.size()});
  }
}

InputFile::~InputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Bytes InputFile::read(std::size_t first, std::size_t count) const {
  Bytes bytes(count);
  if (read_into(bytes, first) < count) fail(file_, "could not be read to its end");
  return bytes;
}

std::size_t InputFile::read_into(std::span<std::uint8_t> bytes, std::size_t first) const {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t got =
        ::pread(descriptor_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(first + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw_read_error(file_, "cannot be read", errno);
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  return done;
}

Bytes read_whole_file(const std::filesystem::path& file) {
  const InputFile input(file);
  return input.read(0, input.size());
}

}  // namespace simvis
