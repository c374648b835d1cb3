// Which users may connect to a host.
#pragma once

#include <cstdint>

namespace simvis {

enum class SharedAccess : std::uint8_t {
  user,  ///< programs of the host's user: mode 0600
  group  ///< those of its group too: mode 0660
};

}  // namespace simvis
