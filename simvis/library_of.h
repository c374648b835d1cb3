// Which shared library a type's code is in, for messages.
#pragma once

#include <string>

namespace simvis {

/// The file of the library or program that holds the code at `address`, or "an unknown library".
std::string library_of(const void* address);

}  // namespace simvis
