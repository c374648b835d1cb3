#include "simvis/unbuilt_scene.h"

#include <utility>

#include <simvis/location.h>
#include <simvis/part_importer.h>

namespace simvis {
namespace {

// A part file given as the scene is a common mistake, and its content would only be reported as malformed XML.
std::vector<Command> read_scene(const std::filesystem::path& file) {
  if (file.extension() != ".xml" && find_part_importer(file) != nullptr) {
    throw InputError(file.string() +
                     ": error: this is the file of a part, expected a scene; put it into one: <part file=" +
                     in_quotes(file.filename().string()) + " name=\"PART\" insert_at=\"ROOT\"/>");
  }
  return read_commands(file);
}

}  // namespace

UnbuiltScene UnbuiltScene::of_file(const std::filesystem::path& file) {
  const InputLog log;
  UnbuiltScene scene{.commands = read_scene(file), .name = file.string(), .inputs = {}};
  scene.inputs.add(log);
  return scene;
}

UnbuiltScene UnbuiltScene::of_text(std::string_view xml, const std::filesystem::path& folder, const std::string& name) {
  const InputLog log;
  UnbuiltScene scene{.commands = parse_commands(xml, name, folder), .name = name, .inputs = {}};
  scene.inputs.add(log);
  return scene;
}

std::unique_ptr<SimulationImpl> UnbuiltScene::build(const SimulationDesc& desc) const {
  const InputLog log;
  auto impl = std::make_unique<SimulationImpl>(desc, commands, name);
  impl->inputs = inputs;
  impl->inputs.add(log);
  return impl;
}

}  // namespace simvis
