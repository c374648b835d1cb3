#include "simvis/plugins/library_of.h"

#include <dlfcn.h>

namespace simvis {

std::string library_of(const void* address) {
  Dl_info info{};
  if (::dladdr(address, &info) == 0 || info.dli_fname == nullptr) return "an unknown library";
  return info.dli_fname;
}

}  // namespace simvis
