#include "clients/shared_object.h"

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

#include "clients/shared_words.h"

namespace simvis {
namespace {

// Capacities of the tables. A table reserves address space for its capacity; only its used part takes memory.
constexpr std::uint64_t kElements = 1 << 20, kParameters = 1 << 21, kSensors = 1 << 12, kStringBytes = 64 << 20,
                        kOutputBytes = std::uint64_t{4} << 30;
// Memory is asked for in such pieces, so that a full file system is an error here and not a signal later.
constexpr std::uint64_t kPiece = 1 << 18;
constexpr char kFolder[] = "/dev/shm";
// A host that removes what a dead one left holds a lock on this byte meanwhile; another one waits for a second at most.
constexpr std::uint64_t kRemovalByte = SIMVIS_SHM_LOCK_BYTE + 1;
constexpr int kRemovalTries = 1000;
constexpr useconds_t kRemovalPause_us = 1000;

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

SharedObject::SharedObject(const std::string& name, SharedAccess access)
    : name_(name), path_(std::string(kFolder) + SIMVIS_SHM_PREFIX + name) {
  make_unnamed(access);
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
  struct stat own {
  }, named{};
  if (::fstat(file_, &own) == 0 && ::stat(path_.c_str(), &named) == 0 && own.st_ino == named.st_ino) {
    ::unlink(path_.c_str());
  }
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
  fail("no memory is left in " + std::string(kFolder) + " for what is served");
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

void SharedObject::make_unnamed(SharedAccess access) {
  file_ = ::open(kFolder, O_TMPFILE | O_RDWR | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (file_ < 0) fail(std::string("no shared memory in ") + kFolder);
  const mode_t mode = S_IRUSR | S_IWUSR | (access == SharedAccess::group ? S_IRGRP | S_IWGRP : 0);
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

// Links the complete object under its name.
void SharedObject::publish() {
  const std::string own = "/proc/self/fd/" + std::to_string(file_);
  for (int tries = 0; ::linkat(AT_FDCWD, own.c_str(), AT_FDCWD, path_.c_str(), AT_SYMLINK_FOLLOW) != 0; ++tries) {
    if (errno != EEXIST) fail("the shared memory " + path_ + " can't get its name");
    if (tries == kRemovalTries) throw MachineError("the shared memory " + path_ + " is being removed, and stays");
    remove_dead();
  }
}

// An object that a dead host left under the name is removed, by one host at a time: it holds the lock for that. The
// lock of a living host stays free, so that no client takes the dead one for living.
void SharedObject::remove_dead() const {
  const int before = ::open(path_.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW);
  if (before < 0 && errno == ENOENT) return;
  if (before < 0) fail("the shared memory " + path_ + " can't be opened");
  const bool may_remove = take_lock(before, kRemovalByte);
  const bool is_living = is_byte_locked(before, SIMVIS_SHM_LOCK_BYTE);
  struct stat locked {
  }, named{};
  const bool is_it =
      ::fstat(before, &locked) == 0 && ::stat(path_.c_str(), &named) == 0 && locked.st_ino == named.st_ino;
  if (may_remove && !is_living && is_it) ::unlink(path_.c_str());
  ::close(before);
  if (is_living && is_it) throw InputError("a living simulation is served as \"" + name_ + "\", expected another name");
  if (!may_remove) ::usleep(kRemovalPause_us);
}

}  // namespace simvis
