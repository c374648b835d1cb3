#include "simvis/library_of.h"

#include <dlfcn.h>

#include <simvis/sensor.h>

namespace simvis {

std::string library_of(const void* address) {
  Dl_info info{};
  if (::dladdr(address, &info) == 0 || info.dli_fname == nullptr) return "an unknown library";
  return info.dli_fname;
}

bool is_of_the_library(const SensorType& type) {
  return library_of(reinterpret_cast<const void*>(type.create)) ==
         library_of(reinterpret_cast<const void*>(&is_of_the_library));
}

}  // namespace simvis
