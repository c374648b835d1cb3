#include "program/options/settings.h"

#include <algorithm>

#include <simvis/error.h>
#include <simvis/location.h>
#include "engine/base/assert.h"

namespace simvis {
namespace {

constexpr SettingSpec kSettings[] = {
    {.name = "rate_hz",
     .field = [](SimulationDesc& desc) -> SettingField { return &desc.rate_hz; },
     .text = "frames per simulated second",
     .absent = "a frame exactly when a sensor is due",
     .is_absent = [](SimulationDesc& desc) { return &desc.frames_when_due; }},
    {.name = "seed",
     .field = [](SimulationDesc& desc) -> SettingField { return &desc.seed; },
     .text = "seed of all random numbers"},
    {.name = "threads",
     .field = [](SimulationDesc& desc) -> SettingField { return &desc.threads; },
     .text = "number of threads on which SimVis casts rays, culls views and prepares meshes, up to 1024; 0: one for "
             "each core. Results do not depend on the number. The Vulkan driver has threads of its own"},
    {.name = "device",
     .field = [](SimulationDesc& desc) -> SettingField { return &desc.device.select; },
     .text = "the Vulkan device: part of its name, its index, or `bundled` for that of the driver that SimVis was "
             "built with; without it the best device"},
    {.name = "strict",
     .field = [](SimulationDesc& desc) -> SettingField { return &desc.strict; },
     .text = "warnings are errors"},
    {.name = "sensors",
     .field = [](SimulationDesc& desc) -> SettingField { return &desc.sensors; },
     .text = "names of the sensors that are on at first; what only others need is not loaded; without it all are on"},
    {.name = "overrides",
     .field = [](SimulationDesc& desc) -> SettingField { return &desc.overrides; },
     .text = "attributes of all sensors of a type, such as `{\"laser_scanner.method\": \"planar\"}`; `None` removes "
             "one"},
    {.name = "packages",
     .field = [](SimulationDesc& desc) -> SettingField { return &desc.packages; },
     .text = "folders of ROS packages or Gazebo models that parts name, searched first"},
    {.name = "instrumented",
     .field = [](SimulationDesc& desc) -> SettingField { return &desc.device.instrumented; },
     .text = "measure times on the device; no result depends on it"},
    {.name = "cache_dir",
     .field = [](SimulationDesc& desc) -> SettingField { return &desc.device.cache_dir; },
     .text = "folder of caches; without it `$XDG_CACHE_HOME/simvis` or `~/.cache/simvis`",
     .is_path = true},
    {.name = "progress",
     .field = [](SimulationDesc& desc) -> SettingField { return &desc.progress; },
     .text = "called with the work, what is done and all that there is, while parts are read"},
};

}  // namespace

std::span<const SettingSpec> simulation_settings() { return kSettings; }

const SettingSpec& simulation_setting(std::string_view name) {
  const auto found = std::ranges::find(kSettings, name, &SettingSpec::name);
  SIMVIS_ASSERT(found != std::end(kSettings));
  return *found;
}

AttributeOverride named_override(const std::string& name, const std::optional<std::string>& value) {
  const std::size_t dot = name.find('.');
  if (dot == std::string::npos) {
    throw InputError("override " + in_quotes(name) + ": expected TYPE.ATTRIBUTE, such as \"laser_scanner.method\"");
  }
  return {name.substr(0, dot), name.substr(dot + 1), value, ""};
}

}  // namespace simvis
