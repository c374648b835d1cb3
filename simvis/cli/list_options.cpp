#include "simvis/cli/list_options.h"

#include <CLI/CLI.hpp>

#include <simvis/command.h>
#include <simvis/error.h>
#include "simvis/live_scene.h"
#include "simvis/report/scene_check.h"
#include "simvis/report/scene_list.h"

namespace simvis {

void declare_list_options(CLI::App& app, ListOptions& options) {
  CLI::Option* const list =
      app.add_flag("--list", options.scene,
                   "print the parts of the scene with their sizes, its elements with their parameters, its sensors and "
                   "warnings, and exit; needs no device");
  app.add_flag("--check", options.check,
               "print what is probably a mistake in the scene, such as a part in another unit or a sensor within a "
               "solid, and exit with status 1 if there is any; needs no device");
  app.add_flag("--json", options.json, "with --list: as JSON")->needs(list);
  app.add_flag("--list-types", options.types, "print every element, sensor and effect type with one line, and exit");
}

std::string scene_listing(const std::string& scene, const SimulationDesc& desc, bool json) {
  if (scene.empty()) throw InputError("SCENE.xml is missing, expected a scene to list; see --help");
  const LiveScene live(desc.overrides, read_commands(scene), desc.seed, {}, desc.packages, desc.strict);
  const SceneList list = list_scene(live.built);
  return json ? to_json(list) : to_text(list);
}

SceneCheck scene_check(const std::string& scene, const SimulationDesc& desc) {
  if (scene.empty()) throw InputError("SCENE.xml is missing, expected a scene to check; see --help");
  const LiveScene live(desc.overrides, read_commands(scene), desc.seed, {}, desc.packages, desc.strict);
  const std::vector<std::string> problems = check_scene(live.built);
  SceneCheck result{.text = {}, .warnings = live.built.scene.warnings(), .has_problems = !problems.empty()};
  for (const std::string& problem : problems) result.text += problem + "\n";
  const std::string count = problems.empty() ? "no problems" : std::to_string(problems.size()) + " problem";
  result.text += count + (problems.size() > 1 ? "s" : "") + " found\n";
  return result;
}

}  // namespace simvis
