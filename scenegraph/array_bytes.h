// The numbers of an array as bytes: count() of held_type(), in order and without gaps. Shared memory, messages, pickles
// and pages have this layout.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <simvis/measurement.h>
#include "engine/base/program_api.h"

namespace simvis {

/// How many bytes they take.
SIMVIS_PROGRAM_API std::size_t own_size(const MeasuredArray& array);

/// Writes them; `to` has room for own_size() bytes, and need not be aligned.
SIMVIS_PROGRAM_API void copy_numbers(const MeasuredArray& array, void* to);

/// All of them.
SIMVIS_PROGRAM_API std::vector<std::uint8_t> own_bytes(const MeasuredArray& array);

}  // namespace simvis
