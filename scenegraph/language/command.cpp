#include <simvis/command.h>

#include <algorithm>
#include <pugixml.hpp>

#include <simvis/attributes.h>
#include "scenegraph/language/source_text.h"
#include "scenegraph/language/xml_error.h"

namespace simvis {
namespace {

constexpr std::string_view kCommandNames[] = {"part", "element", "sensor"};  // in the order of CommandKind
constexpr std::string_view kCommandSpaces = " \t\r\n";

bool is_command(std::string_view tag) { return std::ranges::find(kCommandNames, tag) != std::end(kCommandNames); }

Location place(const pugi::xml_node& node, const SourceText& source) {
  return source.at(static_cast<std::size_t>(node.offset_debug()));
}

// Returns the offsets of the attributes' names, in order. pugixml does not store them, so the tag is scanned again. The
// tag is known to be well formed.
std::vector<std::size_t> attribute_offsets(const pugi::xml_node& node, std::string_view text) {
  std::vector<std::size_t> offsets;
  std::size_t i = static_cast<std::size_t>(node.offset_debug()) + std::string_view(node.name()).size();
  while (true) {
    i = text.find_first_not_of(kCommandSpaces, i);
    if (i == std::string_view::npos || text[i] == '>' || text[i] == '/') return offsets;
    offsets.push_back(i);
    i = text.find_first_of("\"'", i);
    if (i == std::string_view::npos) return offsets;
    i = text.find(text[i], i + 1);
    if (i == std::string_view::npos) return offsets;
    ++i;
  }
}

void check_name(const CommandAttribute& name, CommandKind kind) {
  const auto refuse = [&](std::string_view expected) {
    fail_at(name.where,
            "attribute \"name\": " + in_quotes(name.value) + " is not allowed, expected " + std::string(expected));
  };
  if (name.value.find_first_not_of(kCommandSpaces) == std::string::npos) refuse("a name that is not empty");
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  if (std::ranges::any_of(name.value, is_control)) refuse("a name without control characters");
  if (kind != CommandKind::part && name.value.find_first_of("./") != std::string::npos) {
    refuse("a name without '.' and '/'");
  }
}

Command read_command(const pugi::xml_node& node, const SourceText& source, const std::filesystem::path& folder) {
  const std::string_view tag = node.name();
  if (!is_command(tag)) {
    fail_at(place(node, source), "unknown command " + in_quotes(tag) + suggestion(tag, kCommandNames) +
                                     " (expected part, element or sensor)");
  }
  Command command;
  command.kind = static_cast<CommandKind>(std::ranges::find(kCommandNames, tag) - std::begin(kCommandNames));
  command.where = place(node, source);
  command.folder = folder;
  const std::vector<std::size_t> offsets = attribute_offsets(node, source.text());
  std::size_t i = 0;
  for (const pugi::xml_attribute& attribute : node.attributes()) {
    const Location where = i < offsets.size() ? source.at(offsets[i]) : command.where;
    ++i;
    if (command.find(attribute.name()) != nullptr) {
      fail_at(where, "attribute " + in_quotes(attribute.name()) + " is given twice, expected once");
    }
    command.attributes.push_back({attribute.name(), attribute.value(), where});
  }
  if (const pugi::xml_node child = node.first_child()) {
    fail_at(place(child, source), "a command has no content, expected <" + std::string(tag) + " .../>");
  }
  if (const CommandAttribute* name = command.find("name")) check_name(*name, command.kind);
  return command;
}

// Returns the only element of the document if it is not a command but encloses commands.
pugi::xml_node find_root(const pugi::xml_document& document) {
  const pugi::xml_node first = document.first_child();
  const bool alone = first && !first.next_sibling() && first.type() == pugi::node_element;
  // An only element with attributes and without content is a misspelt command, and is reported as a command.
  const bool encloses = alone && (first.first_child() || !first.first_attribute());
  return encloses && !is_command(first.name()) ? first : pugi::xml_node();
}

[[noreturn]] void refuse_text(const pugi::xml_node& node, const SourceText& source) {
  std::string_view text = node.value();
  const std::size_t spaces = std::min(text.find_first_not_of(kCommandSpaces), text.size());
  text = text.substr(spaces, text.find_last_not_of(kCommandSpaces) + 1 - spaces);
  fail_at(source.at(static_cast<std::size_t>(node.offset_debug()) + spaces),
          "text " + in_quotes(text) + " between commands, expected commands only");
}

std::vector<Command> parse(const SourceText& source, const std::filesystem::path& folder) {
  pugi::xml_document document;
  const std::string& text = source.text();
  const pugi::xml_parse_result result =
      document.load_buffer(text.data(), text.size(), pugi::parse_default | pugi::parse_fragment, pugi::encoding_utf8);
  if (!result) fail_xml(source, result);
  const pugi::xml_node root = find_root(document);
  if (root && std::string_view(root.name()) == "robot" && root.child("link")) {
    fail_at(place(root, source), "this is a robot in URDF, expected a scene; put it into one: <part file=" +
                                     in_quotes(std::filesystem::path(source.file()).stem().string() + ".urdf") +
                                     " name=\"ROBOT\" insert_at=\"ROOT\"/>");
  }
  if (root && root.first_attribute()) {
    fail_at(source.at(attribute_offsets(root, text).front()),
            "unknown attribute " + in_quotes(root.first_attribute().name()) + ", expected none on the root element");
  }
  std::vector<Command> commands;
  for (const pugi::xml_node& node : root ? root.children() : document.children()) {
    if (node.type() != pugi::node_element) refuse_text(node, source);
    commands.push_back(read_command(node, source, folder));
  }
  return commands;
}

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

std::string_view to_string(CommandKind kind) { return kCommandNames[static_cast<std::size_t>(kind)]; }

std::string to_string(const Command& command) {
  std::string text = "<" + std::string(to_string(command.kind));
  for (const CommandAttribute& attribute : command.attributes) {
    text += " " + attribute.name + "=\"";
    append_escaped(text, attribute.value);
    text += '"';
  }
  return text + "/>";
}

std::vector<Command> parse_commands(std::string_view xml, const std::string& file,
                                    const std::filesystem::path& folder) {
  return parse(SourceText(xml, file), folder);
}

std::vector<Command> read_commands(const std::filesystem::path& file) {
  return parse(SourceText::read(file), file.parent_path());
}

}  // namespace simvis
