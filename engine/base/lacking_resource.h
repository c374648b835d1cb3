// The reason why a process cannot load a library: too little memory, or too many open files.
#pragma once

#include <cstddef>
#include <string>

namespace simvis {

/// Returns why this process cannot take `memory_bytes` of memory or open another file, such as "less than 256 MiB of
/// memory are left: Cannot allocate memory"; empty if it can do both.
std::string lacking_resource(std::size_t memory_bytes);

}  // namespace simvis
