#include "exchange/clients/shared_object.h"

#include <fcntl.h>
#include <linux/futex.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstring>
#include <random>

#include "exchange/clients/shared_words.h"

namespace simvis {
namespace {

// Capacities of the tables. A table reserves address space for its capacity; only its used part takes memory.
constexpr std::uint64_t kElements = 1 << 20, kParameters = 1 << 21, kSensors = 1 << 12, kStringBytes = 64 << 20,
                        kOutputBytes = std::uint64_t{4} << 30;
// Memory is asked for in such pieces, so that a lack of it is an error here and not a signal later.
constexpr std::uint64_t kPiece = 1 << 18;

struct flock lock_of(std::uint64_t byte) {
  struct flock lock {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  lock.l_start = static_cast<off_t>(byte);
  lock.l_len = 1;
  return lock;
}

bool take_lock(int file, std::uint64_t byte) {
  struct flock lock = lock_of(byte);
  return ::fcntl(file, F_OFD_SETLK, &lock) == 0;
}

bool is_byte_locked(int file, std::uint64_t byte) {
  struct flock lock = lock_of(byte);
  return ::fcntl(file, F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
}

void wake(const std::uint32_t& word) { ::syscall(SYS_futex, &word, FUTEX_WAKE, INT_MAX, nullptr, nullptr, 0); }

[[noreturn]] void fail(const std::string& what) { throw MachineError(what + ": " + std::strerror(errno)); }

}  // namespace

SharedObject::SharedObject(const std::string& name, SharedAccess access) : name_(name), access_(access) {
  make_file();
  try {
    map();
    describe();
    // The lock is held before other processes can find the object.
    if (!take_lock(file_, SIMVIS_SHM_LOCK_BYTE)) fail("the shared memory can't be locked");
  } catch (...) {
    release();
    throw;
  }
}

SharedObject::~SharedObject() {
  store(shared().state, static_cast<std::uint32_t>(SIMVIS_ENDED));
  wake_frame();
  listener_.reset();
  release();
}

bool SharedObject::is_locked(std::uint64_t byte) const { return is_byte_locked(file_, byte); }

void SharedObject::wake_frame() {
  store(shared().frame_futex, ++frame_futex_);
  wake(shared().frame_futex);
}

void SharedObject::publish_count(simvis_region& region, std::uint64_t count) {
  region.count = count;
  store((&shared().elements)[&region - &layout_.elements].count, count);
}

void SharedObject::give_back(std::uint64_t offset, std::uint64_t bytes) {
  ::fallocate(file_, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, static_cast<off_t>(offset), static_cast<off_t>(bytes));
}

void SharedObject::allocate(std::uint64_t offset, std::uint64_t bytes) {
  const int error = ::posix_fallocate(file_, static_cast<off_t>(offset), static_cast<off_t>(bytes));
  if (error == 0) return;
  errno = error;
  fail("no memory is left for what is served");
}

void SharedObject::ensure(const simvis_region& region, std::uint64_t bytes) {
  std::uint64_t& ensured = ensured_[&region - &layout_.elements];
  if (bytes <= ensured) return;
  const std::uint64_t wanted = std::min(round_up(bytes, kPiece), region.capacity * region.stride);
  allocate(region.offset + ensured, wanted - ensured);
  ensured = wanted;
}

void SharedObject::release() {
  if (memory_ != nullptr) ::munmap(memory_, layout_.total_size);
  ::close(file_);
}

void SharedObject::make_file() {
  file_ = ::memfd_create((SIMVIS_SHM_PREFIX + name_).c_str(), MFD_CLOEXEC | MFD_ALLOW_SEALING);
  if (file_ < 0) fail("no shared memory");
  const mode_t mode = S_IRUSR | S_IWUSR | (access_ == SharedAccess::group ? S_IRGRP | S_IWGRP : 0);
  if (::fchmod(file_, mode) != 0) fail("the shared memory can't be given to the group");
}

void SharedObject::map() {
  simvis_header& layout = layout_;
  std::uint64_t end = round_up(sizeof(simvis_header), kPage);
  layout.clients_offset = end;
  end = round_up(end + SIMVIS_SHM_CLIENTS * sizeof(simvis_client_area), kPage);
  const auto reserve = [&](simvis_region& region, std::uint64_t stride, std::uint64_t capacity) {
    region = {.offset = end, .stride = stride, .capacity = capacity, .count = 0};
    end = round_up(end + stride * capacity, kPage);
  };
  reserve(layout.elements, sizeof(simvis_element), kElements);
  reserve(layout.parameters, sizeof(simvis_parameter), kParameters);
  reserve(layout.values, sizeof(double), kParameters);
  reserve(layout.applied, sizeof(double), kParameters);
  reserve(layout.strings, 1, kStringBytes);
  reserve(layout.log, 1, kLogBytes);
  reserve(layout.sensors, sizeof(simvis_sensor), kSensors);
  reserve(layout.outputs, 1, kOutputBytes);
  layout.total_size = end;
  if (::ftruncate(file_, static_cast<off_t>(end)) != 0) fail("the shared memory can't be made");
  // From now on no process can make it shorter, which would end those that read it.
  if (::fcntl(file_, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) != 0) {
    fail("the size of the shared memory can't be fixed");
  }
  allocate(0, layout.elements.offset);
  void* const memory = ::mmap(nullptr, end, PROT_READ | PROT_WRITE, MAP_SHARED, file_, 0);
  if (memory == MAP_FAILED) fail("the shared memory can't be mapped");
  memory_ = static_cast<unsigned char*>(memory);
}

void SharedObject::describe() {
  simvis_header& made = layout_;
  made.magic = SIMVIS_SHM_MAGIC;
  made.version = SIMVIS_SHM_VERSION;
  made.header_size = sizeof made;
  std::random_device random;
  made.generation = std::uint64_t{random()} << 32 | random();
  made.host_pid = ::getpid();
  made.state = SIMVIS_RUNNING;
  shared() = made;
}

void SharedObject::publish() { listener_.emplace(name_, file_, access_); }

}  // namespace simvis
