// The file in memory that a host shares with its clients, and its mapping: layout, names, locks and memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include <simvis/error.h>
#include <simvis_client/shared_memory.h>
#include "engine/base/assert.h"
#include "exchange/clients/client_listener.h"
#include "exchange/clients/shared_access.h"

namespace simvis {

/// Clients cannot fill the log: beyond this share their refusals are no longer logged, and their requests wait for
/// ever.
constexpr std::uint64_t kLogBytes = 256 << 20, kLogBytesOfClients = kLogBytes / 4 * 3;

/// Errors   InputError: another process has the name. MachineError: the system refuses memory.
/// Threads  one at a time.
class SharedObject {
 public:
  /// Makes the object, which clients cannot find before publish(). Its size is fixed: no process can make it shorter.
  SharedObject(const std::string& name, SharedAccess access);
  SharedObject(const SharedObject&) = delete;
  SharedObject& operator=(const SharedObject&) = delete;
  /// Tells clients that the host ends. The memory goes with the last of them.
  ~SharedObject();

  /// Gives the object its name.
  void publish();

  /// The host's own copy of the offsets and counts, which no client can change.
  simvis_header& layout() { return layout_; }
  simvis_header& shared() { return *reinterpret_cast<simvis_header*>(memory_); }
  unsigned char* at(std::uint64_t offset) { return memory_ + offset; }

  /// Whether a living process holds the lock on a byte of the object. The lock ends with the process.
  bool is_locked(std::uint64_t byte) const;
  /// Tells waiting clients of a finished frame.
  void wake_frame();

  /// Room for `count` entries behind those of a region of layout().
  template <typename T>
  T* append(simvis_region& region, std::size_t count) {
    SIMVIS_ASSERT(sizeof(T) == region.stride);
    if (count > region.capacity - region.count) throw MachineError("the tables of the shared memory are full");
    ensure(region, (region.count + count) * region.stride);
    return reinterpret_cast<T*>(at(region.offset)) + region.count;
  }
  /// Says that a region of layout() has this many entries.
  void publish_count(simvis_region& region, std::uint64_t count);

  /// Asks the system for memory; writing to it can't fail after that.
  void allocate(std::uint64_t offset, std::uint64_t bytes);
  /// Gives memory back to the system; it reads as 0 until it is allocated again.
  void give_back(std::uint64_t offset, std::uint64_t bytes);

 private:
  void make_file();
  void map();
  void describe();
  void ensure(const simvis_region& region, std::uint64_t bytes);
  void release();

  std::string name_;
  SharedAccess access_;
  int file_ = -1;
  unsigned char* memory_ = nullptr;
  simvis_header layout_{};
  std::uint32_t frame_futex_ = 0;
  std::array<std::uint64_t, 8> ensured_{};  // bytes by region, in the order of the header
  std::optional<ClientListener> listener_;
};

}  // namespace simvis
