// The messages of a running simulation, for callers that do not write them to a file.
#pragma once

#include "engine/base/program_api.h"
#include "messages/message_outlet.h"

namespace simvis {

class Simulation;

/// From now on, the messages of each step also go to `outlet`, which must outlive the simulation, in the order of
/// docs/messages.md; null ends this. Throws InputError: two sensors would have the same topics. If a later command
/// makes such sensors, the messages end with a warning.
SIMVIS_PROGRAM_API void send_messages(Simulation& simulation, ros::MessageOutlet* outlet);

}  // namespace simvis
