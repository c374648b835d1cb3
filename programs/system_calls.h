// The system calls that a helper program may make.
#pragma once

namespace simvis {

/// From now on this process can read files and compute: it cannot write, make, rename or remove files, open
/// connections, start or signal other processes, gain rights, or reach what kernels rarely defend, such as bpf() and
/// io_uring. Such calls fail with EPERM. Holds for later threads. Does nothing in programs with a sanitizer and, beyond
/// the rights, where the kernel has no filter for system calls.
void restrict_system_calls();

}  // namespace simvis
