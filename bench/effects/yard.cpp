#include "bench/effects/yard.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace simvis::bench {

namespace {

namespace fs = std::filesystem;

/// Returns the example with another value of its knob.
std::string with_knob(std::string_view example, std::string_view knob, std::string_view value) {
  std::string text(example);
  const std::string written = ' ' + std::string(knob) + "=\"";
  const std::size_t at = value.empty() ? text.npos : (' ' + text).find(written);
  if (at == text.npos) return text;
  const std::size_t first = at + written.size() - 1;
  return text.replace(first, text.find('"', first) - first, value);
}

}  // namespace

const EffectExample& example_of(const EffectType& effect) {
  const EffectExample* const example = find_effect_example(effect.name);
  if (example == nullptr) throw std::logic_error("no example of the effect " + std::string(effect.name));
  return *example;
}

Setting with_effect(const EffectType& effect, const Watcher& watcher, std::string_view value) {
  const EffectExample& example = example_of(effect);
  Setting setting{example_commands(example, with_knob(example.commands, effect.knob, value))};
  if (may_have(watcher.type, effect)) setting.attributes = with_knob(example.attributes, effect.knob, value);
  return setting;
}

Setting without_effect(const EffectType& effect) {
  const EffectExample& example = example_of(effect);
  return {example_commands(example, example.plain_commands)};
}

bool can_show(const EffectType& effect, const Watcher& watcher) {
  return (effect.outputs & watcher.shows) != 0 && (effect.attributes.empty() || may_have(watcher.type, effect));
}

Simulation yard(const Watcher& watcher, const Setting& setting) {
  const fs::path file = fs::path(SIMVIS_SOURCE_DIR) / "scenes/showcase/showcase.xml";
  std::ifstream stream(file);
  std::string xml(std::istreambuf_iterator<char>(stream), {});
  xml.insert(xml.rfind("</simvis>"), setting.commands + "<sensor type=\"" + std::string(watcher.type) +
                                         "\" name=\"WATCH\" insert_at=\"ROOT\" " + std::string(watcher.attributes) +
                                         ' ' + setting.attributes + "/>");
  Simulation simulation = Simulation::from_string(xml, {}, file.parent_path(), file.string());
  for (const SensorInfo& each : simulation.sensors()) simulation.enable(each.name, each.name == "WATCH");
  return simulation;
}

}  // namespace simvis::bench
