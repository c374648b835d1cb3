// The name of the shared library that contains the code of a type, for messages.
#pragma once

#include <string>

namespace simvis {

/// The file of the library or program that contains the code at `address`, or "an unknown library".
std::string library_of(const void* address);

}  // namespace simvis
