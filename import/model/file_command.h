// The text of a command that a part file brings.
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <string_view>
#include <utility>

#include <simvis/attributes.h>
#include <simvis/command.h>

namespace simvis {

class FileCommand {
 public:
  /// `insert_at` is empty for the part itself.
  FileCommand(CommandKind kind, const char* type, const std::string& name, const std::string& insert_at) {
    command_.kind = kind;
    add("type", type);
    add("name", name);
    if (!insert_at.empty()) add("insert_at", insert_at);
  }
  void add(const char* name, std::string value) { command_.attributes.push_back({name, std::move(value), {}}); }
  void add(const char* name, double value) { add(name, format_number(value)); }
  void add(const char* name, const glm::dvec3& v) {
    add(name, format_number(v.x) + " " + format_number(v.y) + " " + format_number(v.z));
  }
  const std::string& type() const { return command_.attributes.front().value; }
  /// As written; empty: there is none.
  std::string_view find(std::string_view name) const {
    const CommandAttribute* const found = command_.find(name);
    return found == nullptr ? std::string_view() : std::string_view(found->value);
  }
  std::string text() const { return to_string(command_); }

 private:
  Command command_;
};

}  // namespace simvis
