// How far a participant of DDS looks for others, as the environment variables of ROS 2 say.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace simvis::ros {

/// ROS_AUTOMATIC_DISCOVERY_RANGE.
enum class DiscoveryRange : std::uint8_t {
  unset,      ///< Cyclone's own way, like subnet and system_default
  localhost,  ///< participants of this machine; with peers those too
  off         ///< none, not on this machine either
};

/// What the environment says of discovery.
struct Discovery {
  DiscoveryRange range = DiscoveryRange::unset;
  std::vector<std::string> peers{};       ///< ROS_STATIC_PEERS: host names and addresses
  std::optional<std::uint32_t> domain{};  ///< ROS_DOMAIN_ID
};

/// Reads ROS_LOCALHOST_ONLY, which goes before the others, ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_STATIC_PEERS and
/// ROS_DOMAIN_ID. Throws InputError: a value that ROS 2 does not have.
Discovery discovery_of_environment();

/// The same as a fragment of Cyclone's configuration, which CYCLONEDDS_URI may follow; empty: nothing differs from
/// Cyclone's own way. `chooses_interface` is false where CYCLONEDDS_URI chooses the network interfaces.
std::string cyclone_config(const Discovery& discovery, bool chooses_interface = true);

}  // namespace simvis::ros
