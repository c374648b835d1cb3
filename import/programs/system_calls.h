// The system calls that a helper program may make.
#pragma once

#include <cstdint>
#include <vector>

namespace simvis {

/// The programs that read strangers' files; the last two are Python.
enum class HelperProgram : std::uint8_t { decode, mesh, inventor, usd, xacro };

/// The numbers of all system calls that the program may make, some of them with few arguments only.
std::vector<int> allowed_system_calls(HelperProgram program);

/// From now on all threads of this process can make the allowed system calls alone. They read files, compute, start
/// threads and write to what is open; they cannot write, make, rename or remove other files, open connections, start,
/// signal or trace other processes, gain rights, or reach what kernels rarely defend, such as bpf() and io_uring. Other
/// calls fail with EPERM, and those that Linux has since 5.1 with ENOSYS, on which libraries take older ones; a call
/// that starts a program ends xacro (SIGSYS). Returns whether that holds: not in programs with a sanitizer, and not
/// where the kernel has no such filter (seccomp).
bool restrict_system_calls(HelperProgram program);

}  // namespace simvis
