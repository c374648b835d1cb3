#include "simvis/message_tap.h"

#include <memory>

#include <simvis/simulation.h>
#include "simvis/sharing/sent_messages.h"
#include "simvis/simulation_use.h"

namespace simvis {

void send_messages(Simulation& simulation, ros::MessageOutlet* outlet) {
  const SimulationUse use = simulation.impl();
  SimulationImpl& idle = use->idle();
  idle.outlets.remove<SentMessages>();
  if (outlet != nullptr) idle.outlets.add(std::make_unique<SentMessages>(*outlet, idle.scene.built));
}

}  // namespace simvis
