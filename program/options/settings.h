// The settings of a simulation that users give by name: one row for each. The keywords of `simvis.Simulation.load` in
// Python, their checks and documents, and the options of simvis-run that stand for a setting follow from the rows.
// Defaults are those of SimulationDesc.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <simvis/simulation_desc.h>

namespace simvis {

/// The place of a setting in a SimulationDesc. The type of the place is that of the setting.
using SettingField = std::variant<bool*, double*, unsigned*, std::uint64_t*, std::string*, std::vector<std::string>*,
                                  std::vector<AttributeOverride>*, std::vector<PackageFolder>*, ProgressCallback*>;

/// One setting.
struct SettingSpec {
  std::string_view name;                          ///< Python's keyword
  SettingField (*field)(SimulationDesc& desc);    ///< where its value lies
  std::string_view text;                          ///< for users: what it is, with its unit, as Markdown
  std::string_view absent{};                      ///< what it means that there is no value; empty: there is always one
  bool* (*is_absent)(SimulationDesc&) = nullptr;  ///< the flag that says so
  bool is_path = false;                           ///< a text that names a file or a folder
};

/// All settings, in the order of the keywords in Python.
std::span<const SettingSpec> simulation_settings();

/// The setting of this name, which exists.
const SettingSpec& simulation_setting(std::string_view name);

/// The override that `TYPE.ATTRIBUTE` names. Throws InputError for a name without a dot. An empty value removes the
/// attribute of the scene.
AttributeOverride named_override(const std::string& name, const std::optional<std::string>& value);

}  // namespace simvis
