#include "program/cli/saved_scene.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include <simvis/command.h>
#include <simvis/error.h>
#include "scenegraph/language/command_tags.h"
#include "simvis/command_names.h"
#include "simvis/live_scene.h"

namespace simvis {
namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

/// Finds places of a text by line and column.
class Places {
 public:
  explicit Places(std::string_view text) {
    lines_.push_back(0);
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (text[i] == '\n') lines_.push_back(i + 1);
    }
  }
  std::size_t operator[](const Location& where) const {
    return lines_[static_cast<std::size_t>(where.line) - 1] + static_cast<std::size_t>(where.column) - 1;
  }

 private:
  std::vector<std::size_t> lines_;
};

struct Range {
  std::size_t begin, end;
};

/// The value between the quotes, of the attribute whose name begins at `at`.
Range value_range(std::string_view xml, std::size_t at) {
  const std::size_t quote = xml.find_first_of("\"'", at);
  return {quote + 1, xml.find(xml[quote], quote + 1)};
}

/// Behind the last attribute of the command, or behind its name.
std::size_t end_of_attributes(std::string_view xml, const Command& command, const Places& places) {
  std::size_t end = places[command.where];
  while (end < xml.size() && !is_space(xml[end]) && xml[end] != '/' && xml[end] != '>') ++end;
  for (const CommandAttribute& attribute : command.attributes) {
    end = std::max(end, value_range(xml, places[attribute.where]).end + 1);
  }
  return end;
}

/// Where further commands may follow: before the end of the enclosing element, if there is one.
std::size_t end_of_commands(std::string_view xml) {
  const std::size_t closing = xml.rfind("</");
  if (closing == xml.npos) return xml.size();
  const std::string_view rest = xml.substr(closing + 2);
  const std::string_view name = rest.substr(0, rest.find_first_of(" \t\r\n>"));
  return std::ranges::count(kTags, name) > 0 ? xml.size() : closing;
}

std::string with_added(std::string_view xml, const std::filesystem::path& file, std::span<const std::string> added) {
  const std::size_t at = end_of_commands(xml);
  std::string text(xml.substr(0, at));
  if (!added.empty() && !text.empty() && text.back() != '\n') text += '\n';
  std::error_code error;
  const std::string folder = std::filesystem::absolute(file.parent_path(), error).lexically_normal().string();
  const std::string below = folder + (folder.ends_with('/') ? "" : "/");
  for (std::string command : added) {
    for (const Command& parsed : parse_commands(command, file.string(), file.parent_path())) {
      for (const CommandAttribute& attribute : parsed.attributes) {
        const std::string start = " " + attribute.name + "=\"";
        const std::size_t found = refers_to_file(parsed, attribute) ? command.find(start + below) : command.npos;
        if (found != command.npos) command.erase(found + start.size(), below.size());
      }
    }
    text += command + "\n";
  }
  return text + std::string(xml.substr(at));
}

/// The commands that a text has itself, each at a place of its own, by the name of the element that they make.
std::map<std::string, Command> own_elements(std::span<const Command> commands, const std::string& file) {
  std::map<std::string, Command> elements;
  std::map<std::pair<int, int>, int> uses;
  for (const Command& command : commands) ++uses[{command.where.line, command.where.column}];
  for (const Command& command : commands) {
    const bool is_own = command.where.file == file && command.scope == nullptr;
    if (command.kind != CommandKind::element || !is_own) continue;
    if (uses[{command.where.line, command.where.column}] > 1) continue;
    elements.emplace(command.require("name").value, command);
  }
  return elements;
}

class Rewriter {
 public:
  Rewriter(std::string xml, const std::filesystem::path& file, const SimulationDesc& desc)
      : xml_(std::move(xml)), file_(file), desc_(desc), places_(xml_) {}

  SavedScene rewrite(const Parameters& parameters) {
    const std::vector<double> before = values_of(xml_, parameters);
    elements_ = own_elements(parse(xml_), file_.string());
    for (const ElementDescriptor& element : parameters.elements()) {
      for (std::size_t i = 0; i < element.parameters.size() && !element.removed; ++i) {
        const std::size_t index = element.first_value + i;
        if (parameters.values()[index] == before[index]) continue;
        change(element, element.parameters[i], parameters.values()[index]);
      }
    }
    std::ranges::sort(edits_, std::ranges::greater{}, [](const Edit& edit) { return edit.range.begin; });
    for (const Edit& edit : edits_) xml_.replace(edit.range.begin, edit.range.end - edit.range.begin, edit.text);
    if (!edits_.empty()) values_of(xml_, parameters);  // throws if the text is no such scene
    return {xml_, left_};
  }

 private:
  struct Edit {
    Range range;
    std::string text;
  };

  std::vector<Command> parse(const std::string& xml) const {
    return parse_commands(xml, file_.string(), file_.parent_path());
  }

  /// As the text says them.
  std::vector<double> values_of(const std::string& xml, const Parameters& like) const {
    const LiveScene scene(desc_.overrides, parse(xml), desc_.seed, {}, desc_.packages);
    const Parameters& parameters = scene.built.parameters;
    const auto same = [](const ElementDescriptor& a, const ElementDescriptor& b) {
      return a.name == b.name && a.parameters.size() == b.parameters.size();
    };
    if (!std::ranges::equal(parameters.elements(), like.elements(), same)) {
      throw InputError("the scene that runs has other elements than " + file_.string() + " would have");
    }
    const std::span<const double> values = parameters.values();
    return {values.begin(), values.end()};
  }

  void leave(const ElementDescriptor& element, const AttributeSpec& spec, const std::string& why) {
    left_.push_back(element.name + "." + std::string(spec.name) + ": " + why);
  }

  void change(const ElementDescriptor& element, const AttributeSpec& spec, double value) {
    const auto found = elements_.find(element.name);
    if (found == elements_.end()) return leave(element, spec, "its element stands in another file or in a repetition");
    const Command& command = found->second;
    const CommandAttribute* const attribute = command.find(spec.name);
    if (attribute == nullptr) {
      const std::size_t end = end_of_attributes(xml_, command, places_);
      edits_.push_back({{end, end}, " " + std::string(spec.name) + "=\"" + format_number(value) + "\""});
      return;
    }
    const Range range = value_range(xml_, places_[attribute->where]);
    if (xml_.substr(range.begin, range.end - range.begin).find("${") != std::string::npos) {
      return leave(element, spec, "its value is an expression");
    }
    edits_.push_back({range, format_number(value)});
  }

  std::string xml_;
  const std::filesystem::path& file_;
  const SimulationDesc& desc_;
  Places places_;
  std::map<std::string, Command> elements_;
  std::vector<Edit> edits_;
  std::vector<std::string> left_;
};

}  // namespace

SavedScene saved_scene(std::string_view xml, const std::filesystem::path& file, const Parameters& parameters,
                       std::span<const std::string> added, const SimulationDesc& desc) {
  return Rewriter(with_added(xml, file, added), file, desc).rewrite(parameters);
}

}  // namespace simvis
