#include "program/cli/listing.h"

#include <simvis/command.h>
#include <simvis/error.h>
#include "program/report/scene_check.h"
#include "program/report/scene_list.h"
#include "simvis/live_scene.h"

namespace simvis {

std::string scene_listing(const std::string& scene, const SimulationDesc& desc, bool json) {
  if (scene.empty()) throw InputError("SCENE.xml is missing, expected a scene to list; see --help");
  const LiveScene live(desc.overrides, read_commands(scene), desc.seed, {}, desc.packages, desc.strict);
  const SceneList list = list_scene(live.built);
  return json ? to_json(list) : to_text(list);
}

SceneCheck scene_check(const std::string& scene, const SimulationDesc& desc) {
  if (scene.empty()) throw InputError("SCENE.xml is missing, expected a scene to check; see --help");
  const LiveScene live(desc.overrides, read_commands(scene), desc.seed, {}, desc.packages, desc.strict);
  const std::vector<std::string> problems = check_scene(live.built, desc.threads);
  SceneCheck result{.text = {}, .warnings = live.built.scene.warnings(), .has_problems = !problems.empty()};
  for (const std::string& problem : problems) result.text += problem + "\n";
  const std::string count = problems.empty() ? "no problems" : std::to_string(problems.size()) + " problem";
  result.text += count + (problems.size() > 1 ? "s" : "") + " found\n";
  return result;
}

}  // namespace simvis
