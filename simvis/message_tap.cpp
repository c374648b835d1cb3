#include "simvis/message_tap.h"

#include <memory>

#include <simvis/simulation.h>
#include "simvis/simulation_use.h"

namespace simvis {

void send_messages(Simulation& simulation, ros::MessageOutlet* outlet) {
  const SimulationUse use = simulation.impl();
  SimulationImpl& idle = use->idle();
  idle.sent_messages.reset();
  if (outlet != nullptr) idle.sent_messages = std::make_unique<FrameMessages>(*outlet, idle.scene.built, idle.kept);
}

}  // namespace simvis
