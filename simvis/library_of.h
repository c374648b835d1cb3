// The shared library that contains the code of a type.
#pragma once

#include <string>

namespace simvis {

struct SensorType;

/// The file of the library or program that contains the code at `address`, or "an unknown library".
std::string library_of(const void* address);

/// Whether the type comes with SimVis, and not from a plug-in or a program of a user.
bool is_of_the_library(const SensorType& type);

}  // namespace simvis
