#include <simvis/command.h>

#include <algorithm>

#include "scenegraph/language/command_tags.h"

namespace simvis {
namespace {

void append_escaped(std::string& text, std::string_view value) {
  for (const char c : value) {
    switch (c) {
      case '&':
        text += "&amp;";
        break;
      case '<':
        text += "&lt;";
        break;
      case '"':
        text += "&quot;";
        break;
      default:
        if (static_cast<unsigned char>(c) < 0x20) {
          text += "&#" + std::to_string(static_cast<int>(c)) + ";";
        } else {
          text += c;
        }
    }
  }
}

}  // namespace

const CommandAttribute* Command::find(std::string_view name) const {
  const auto found = std::ranges::find(attributes, name, &CommandAttribute::name);
  return found == attributes.end() ? nullptr : &*found;
}

const CommandAttribute& Command::require(std::string_view name) const {
  const CommandAttribute* attribute = find(name);
  if (attribute == nullptr) {
    fail_at(where, std::string(to_string(kind)) + " without attribute \"" + std::string(name) + "\", expected one");
  }
  return *attribute;
}

std::string_view to_string(CommandKind kind) { return kCommandTags[static_cast<std::size_t>(kind)]; }

std::string to_string(const Command& command) {
  std::string text = "<" + std::string(to_string(command.kind));
  for (const CommandAttribute& attribute : command.attributes) {
    text += " " + attribute.name + "=\"";
    append_escaped(text, attribute.value);
    text += '"';
  }
  return text + "/>";
}

}  // namespace simvis
