// The host that a follower finds by DDS.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "engine/base/program_api.h"
#include "simvis/sharing/followed_host.h"

namespace simvis {

/// The simulation that is served under this name in the domain, and of several the one that began last. Throws
/// InputError: no simulation can have the name, a build without DDS. MachineError: the domain cannot be joined.
SIMVIS_PROGRAM_API std::unique_ptr<FollowedHost> host_by_dds(const std::string& name,
                                                             std::optional<std::uint32_t> domain);

}  // namespace simvis
