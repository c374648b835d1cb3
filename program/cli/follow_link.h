// How a follower reaches its host: by shared memory or by DDS.
#pragma once

#include <memory>
#include <string>

#include "simvis/sharing/followed_host.h"

namespace simvis {

/// The host that --follow names: NAME on this machine, dds:NAME or dds:DOMAIN/NAME in a domain of DDS. Throws
/// InputError: a name that no simulation can have, a domain that does not exist, a build without DDS.
std::unique_ptr<FollowedHost> followed_host(const std::string& follow);

}  // namespace simvis
