// Which users may connect to a host.
#pragma once

#include <cstdint>

namespace simvis {

enum class SharedAccess : std::uint8_t {
  user,  ///< programs of the host's user
  group  ///< those with the host's effective group too
};

}  // namespace simvis
