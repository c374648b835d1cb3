// The text of a command that an SDF file brings.
#pragma once

#include <numbers>
#include <string>
#include <utility>

#include <simvis/attributes.h>
#include <simvis/command.h>
#include "import/sdf/sdf_commands.h"

namespace simvis {

/// Degrees of commands per radian of SDF.
inline constexpr double kSdfDegrees = 180 / std::numbers::pi;

class SdfCommand {
 public:
  SdfCommand(CommandKind kind, const char* type, const SdfPlace& place) {
    command_.kind = kind;
    add("type", type);
    add("name", place.name);
    if (!place.insert_at.empty()) add("insert_at", place.insert_at);
  }
  void add(const char* name, std::string value) { command_.attributes.push_back({name, std::move(value), {}}); }
  void add(const char* name, double value) { add(name, format_number(value)); }
  void add(const char* name, const glm::dvec3& v) {
    add(name, format_number(v.x) + " " + format_number(v.y) + " " + format_number(v.z));
  }
  std::string text() const { return to_string(command_); }

 private:
  Command command_;
};

}  // namespace simvis
