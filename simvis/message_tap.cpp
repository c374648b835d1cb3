#include "simvis/message_tap.h"

#include <memory>
#include <span>

#include <simvis/simulation.h>
#include "elements/described_robot.h"
#include "engine/base/input_file.h"
#include "engine/base/read_fence.h"
#include "simvis/built_scene.h"
#include "simvis/sharing/sent_messages.h"
#include "simvis/simulation_use.h"

namespace simvis {

void send_messages(Simulation& simulation, ros::MessageOutlet* outlet) {
  const SimulationUse use = simulation.impl();
  SimulationImpl& idle = use->idle();
  idle.outlets.remove<SentMessages>();
  if (outlet != nullptr) idle.outlets.add(std::make_unique<SentMessages>(*outlet, idle.scene.built));
}

std::vector<CommandInput> command_inputs(const Simulation& simulation) {
  return CommandSources().inputs(built_scene(simulation));
}

std::map<std::string, std::filesystem::path> files_of_robots(const Simulation& simulation) {
  std::map<std::string, std::filesystem::path> files;
  for (const std::unique_ptr<Element>& element : built_scene(simulation).elements) {
    const auto* const robot = dynamic_cast<const DescribedRobot*>(element.get());
    if (robot != nullptr) files.insert(robot->files().begin(), robot->files().end());
  }
  return files;
}

std::optional<std::string> read_robot_file(const std::filesystem::path& file, std::size_t max_bytes) {
  const ReadFence fence(closed_scope({file}));
  const InputFile input(file);
  if (input.size() > max_bytes) return std::nullopt;
  std::string text(input.size(), '\0');
  const std::span<std::uint8_t> bytes(reinterpret_cast<std::uint8_t*>(text.data()), text.size());
  text.resize(input.read_into(bytes, 0));
  return text;
}

void send_command(Simulation& simulation, const CommandInput& input, std::string_view bytes, std::int64_t now_ns) {
  CommandSources sources;
  apply_command(sources.of(built_scene(simulation)), simulation.parameters(), input, bytes, now_ns);
}

}  // namespace simvis
