// Domains of DDS for tests: on this machine alone and without multicast, which a sandbox may not have.
#pragma once

#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <string>

#include <simvis/error.h>
#include "exchange/messages/dds/dds_node.h"

namespace simvis {

/// A domain that hardly another test of this machine has.
inline std::uint32_t own_domain() {
  constexpr const char* kLoopback =
      "<CycloneDDS><Domain><General><Interfaces><NetworkInterface address='127.0.0.1'/></Interfaces>"
      "<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
      "<MaxAutoParticipantIndex>9</MaxAutoParticipantIndex><Peers><Peer address='127.0.0.1'/></Peers></Discovery>"
      "</Domain></CycloneDDS>";
  ::setenv("CYCLONEDDS_URI", kLoopback, 1);
  constexpr std::uint32_t kDomains = 200, kStep = 17;
  static std::uint32_t last = static_cast<std::uint32_t>(::getpid()) % kDomains;
  return last = (last + kStep) % kDomains;
}

/// Throws what a build with DDS throws where DDS cannot work.
inline bool has_dds() {
  try {
    ros::DdsNode node(own_domain());
    return true;
  } catch (const InputError& error) {
    if (std::string(error.what()).find("this build has no DDS") == std::string::npos) throw;
    return false;
  }
}

}  // namespace simvis
