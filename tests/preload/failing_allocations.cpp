// A library that makes allocations of SimVis fail, loaded by LD_PRELOAD or linked before the C++ library. It replaces
// operator new and counts the calls of SimVis's own code in all threads: those whose caller, looked at through the C++
// library, lies in a file whose name has "simvis" in it. Allocations of other libraries are never touched.
//   SIMVIS_FAIL_IN=PROGRAM    only in programs of this name, from their start on, before main()
//   SIMVIS_FAIL_AT=K          the call with this number fails, counted from 1; 0: none does
//   SIMVIS_FAIL_FOR=N         so do the N - 1 calls after it, as while memory is used up; 1 where it is not set
//   SIMVIS_FAIL_MARK=FILE     gets the number of calls and of failed ones when the program ends
// A program that links the library asks by failing_allocations.h instead.
#include "tests/preload/failing_allocations.h"

#include <fcntl.h>
#include <link.h>
#include <unistd.h>
#include <unwind.h>

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

namespace {

// Addresses of the code of one loaded file.
struct CodeRange {
  std::uintptr_t first = 0, end = 0;
  bool has(std::uintptr_t address) const { return first <= address && address < end; }
};

struct CodeRanges {
  static constexpr int kMost = 64;
  CodeRange ranges[kMost];
  int count = 0;

  void add(const dl_phdr_info& file) {
    for (int i = 0; i < file.dlpi_phnum && count < kMost; ++i) {
      const ElfW(Phdr)& segment = file.dlpi_phdr[i];
      if (segment.p_type != PT_LOAD || (segment.p_flags & PF_X) == 0) continue;
      const std::uintptr_t first = file.dlpi_addr + segment.p_vaddr;
      ranges[count++] = {first, first + segment.p_memsz};
    }
  }
  bool has(std::uintptr_t address) const {
    for (int i = 0; i < count; ++i) {
      if (ranges[i].has(address)) return true;
    }
    return false;
  }
};

struct LoadedFiles {
  CodeRanges ours, standard;  // SimVis; the C++ library and this file

  LoadedFiles() { ::dl_iterate_phdr(add, this); }

  static int add(dl_phdr_info* file, std::size_t, void* self) {
    auto& files = *static_cast<LoadedFiles*>(self);
    const bool is_main = file->dlpi_name == nullptr || *file->dlpi_name == '\0';
    const char* const name = is_main ? program_invocation_short_name : std::strrchr(file->dlpi_name, '/');
    if (name == nullptr) return 0;
    if (std::strstr(name, "libstdc++") != nullptr || std::strstr(name, "failing_allocations") != nullptr) {
      files.standard.add(*file);
    } else if (std::strstr(name, "simvis") != nullptr) {
      files.ours.add(*file);
    }
    return 0;
  }
};

const LoadedFiles& loaded_files() {
  static const LoadedFiles files;
  return files;
}

struct Caller {
  std::uintptr_t address = 0;
};

// Finds the innermost caller outside the C++ library.
_Unwind_Reason_Code look_at(_Unwind_Context* frame, void* result) {
  const std::uintptr_t address = _Unwind_GetIP(frame);
  if (loaded_files().standard.has(address)) return _URC_NO_REASON;
  static_cast<Caller*>(result)->address = address;
  return _URC_END_OF_STACK;
}

bool is_ours(void* caller) {
  const auto address = reinterpret_cast<std::uintptr_t>(caller);
  if (loaded_files().ours.has(address)) return true;
  if (!loaded_files().standard.has(address)) return false;
  Caller outer;
  _Unwind_Backtrace(look_at, &outer);
  return loaded_files().ours.has(outer.address);
}

std::atomic<long> calls{0}, failed{0}, first_failing{-1}, failing{1};

long number_in(const char* variable, long otherwise) {
  const char* const text = std::getenv(variable);
  return text == nullptr ? otherwise : std::atol(text);
}

// From the environment, and the mark at the end, also of std::_Exit() and std::quick_exit().
struct Request {
  int mark = -1;

  Request() {
    const char* const program = std::getenv("SIMVIS_FAIL_IN");
    if (program == nullptr || std::strcmp(program, program_invocation_short_name) != 0) return;
    loaded_files();
    if (const char* const file = std::getenv("SIMVIS_FAIL_MARK")) {
      mark = ::open(file, O_CREAT | O_WRONLY | O_TRUNC | O_CLOEXEC, 0600);
    }
    failing = number_in("SIMVIS_FAIL_FOR", 1);
    first_failing = number_in("SIMVIS_FAIL_AT", 0);
    calls = 0;
  }
  ~Request() { write_mark(); }

  void write_mark() const {
    char text[64];
    const int size = std::snprintf(text, sizeof text, "%ld %ld\n", calls.load(), failed.load());
    if (mark >= 0 && ::pwrite(mark, text, static_cast<std::size_t>(size), 0) != size) std::abort();
  }
};

// With the first allocation: libraries allocate before the static objects of this one are made.
Request& request() {
  static Request all;
  return all;
}

bool fails(void* caller) {
  request();
  if (first_failing < 0 || !is_ours(caller)) return false;
  const long call = ++calls, first = first_failing;
  if (first == 0 || call < first || call >= first + failing) return false;
  ++failed;
  request().write_mark();
  return true;
}

void* allocated(std::size_t bytes, std::size_t alignment) {
  if (bytes == 0) bytes = 1;
  if (alignment <= alignof(max_align_t)) return std::malloc(bytes);
  return std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
}

// As the standard says: what a program has set by std::set_new_handler() is called, and the allocation tried again.
void* allocate(std::size_t bytes, std::size_t alignment, void* caller) {
  void* memory = fails(caller) ? nullptr : allocated(bytes, alignment);
  while (memory == nullptr) {
    const std::new_handler handler = std::get_new_handler();
    if (handler == nullptr) throw std::bad_alloc();
    handler();
    memory = allocated(bytes, alignment);
  }
  return memory;
}

}  // namespace

extern "C" {
void simvis_fail_allocations(long first, long count) {
  calls = failed = 0;
  failing = count;
  first_failing = first;
}

SimvisAllocations simvis_count_allocations() { return {calls, failed}; }
}

#define SIMVIS_CALLER __builtin_return_address(0)

void* operator new(std::size_t bytes) { return allocate(bytes, 1, SIMVIS_CALLER); }
void* operator new[](std::size_t bytes) { return allocate(bytes, 1, SIMVIS_CALLER); }
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return allocate(bytes, static_cast<std::size_t>(alignment), SIMVIS_CALLER);
}
void* operator new[](std::size_t bytes, std::align_val_t alignment) {
  return allocate(bytes, static_cast<std::size_t>(alignment), SIMVIS_CALLER);
}
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
  return fails(SIMVIS_CALLER) ? nullptr : allocated(bytes, 1);
}
void* operator new[](std::size_t bytes, const std::nothrow_t&) noexcept {
  return fails(SIMVIS_CALLER) ? nullptr : allocated(bytes, 1);
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
