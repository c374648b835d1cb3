#include "scenegraph/language/command_reader.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <simvis/attributes.h>
#include "engine/base/read_error.h"
#include "scenegraph/language/command_tags.h"
#include "scenegraph/language/control_characters.h"
#include "scenegraph/language/row_names.h"
#include "scenegraph/language/statement_attributes.h"
#include "scenegraph/language/xml_error.h"

namespace simvis {
namespace {

constexpr std::string_view kSpaceCharacters = " \t\r\n";

// Limits of what a short file can make. A scene beyond them is taken for an error.
constexpr std::size_t kMaxSteps = 200'000;          // statements in repetitions and in included files
constexpr std::size_t kStepBytes = 1024;            // of attributes: more of them count as more steps
constexpr std::size_t kMaxNested = 64;              // files that include each other, repetitions in each other
constexpr std::size_t kMaxIncludedBytes = 1 << 28;  // each file as often as it is included

constexpr auto kSetAttributes = names_of(kSetRows);
constexpr auto kRepeatAttributes = names_of(kRepeatRows);
constexpr auto kIncludeAttributes = names_of(kIncludeRows);

bool is_tag(std::string_view tag) { return std::ranges::find(kTags, tag) != std::end(kTags); }

// The root elements of files that parts read, which are no scenes.
struct ModelFile {
  std::string_view root, what, ending, name;
};
constexpr ModelFile kModelFiles[] = {{"robot", "robot in URDF", ".urdf", "ROBOT"},
                                     {"sdf", "world or model in SDF", ".sdf", "WORLD"},
                                     {"mujoco", "model in MJCF", ".xml", "ROBOT"}};

// What newcomers write as commands of their own, and the attribute of the command that they want: its value is the tag,
// except for files.
struct OtherTag {
  std::string_view tag, command, attribute;
};
constexpr OtherTag kOtherTags[] = {{"camera", "sensor", "type"}, {"laser_scanner", "sensor", "type"},
                                   {"imu", "sensor", "type"},    {"gnss", "sensor", "type"},
                                   {"light", "element", "type"}, {"sky", "element", "type"},
                                   {"joint", "element", "type"}, {"physics", "element", "type"},
                                   {"body", "element", "type"},  {"label", "element", "type"},
                                   {"box", "part", "shape"},     {"sphere", "part", "shape"},
                                   {"plane", "part", "shape"},   {"cylinder", "part", "shape"},
                                   {"robot", "part", "file"},    {"model", "part", "file"},
                                   {"mesh", "part", "file"},     {"object", "part", "file"},
                                   {"link", "part", "file"},     {"world", "part", "file"}};

// What the message about an unknown tag expects.
std::string expected_command(std::string_view tag) {
  std::vector<std::string_view> others;
  for (const OtherTag& each : kOtherTags) others.push_back(each.tag);
  const std::string meant = nearest_name(tag, kTags).empty() ? nearest_name(tag, others) : "";
  const auto* const other = std::ranges::find(kOtherTags, meant, &OtherTag::tag);
  if (other != std::end(kOtherTags)) {
    const std::string_view value = other->attribute == "file" ? "..." : other->tag;
    return ", expected <" + std::string(other->command) + " " + std::string(other->attribute) + "=" + in_quotes(value) +
           " .../>";
  }
  return suggestion(tag, kTags) + " (expected part, element, sensor, remove, include, set, repeat or randomize)";
}

Location place(const pugi::xml_node& node, const SourceText& source) {
  return source.at(static_cast<std::size_t>(node.offset_debug()));
}

// Returns the offsets of the attributes' names, in order. pugixml does not store them, so the tag is scanned again. The
// tag is known to be well formed.
std::vector<std::size_t> attribute_offsets(const pugi::xml_node& node, std::string_view text) {
  std::vector<std::size_t> offsets;
  std::size_t i = static_cast<std::size_t>(node.offset_debug()) + std::string_view(node.name()).size();
  while (true) {
    i = text.find_first_not_of(kSpaceCharacters, i);
    if (i == std::string_view::npos || text[i] == '>' || text[i] == '/') return offsets;
    offsets.push_back(i);
    i = text.find_first_of("\"'", i);
    if (i == std::string_view::npos) return offsets;
    i = text.find(text[i], i + 1);
    if (i == std::string_view::npos) return offsets;
    ++i;
  }
}

// "LINK/NAME", as an importer names the sensors of a model: folders within the folder of the results.
bool is_name_with_folders(std::string_view name) {
  return name.find('.') == std::string_view::npos && !name.starts_with('/') && !name.ends_with('/') &&
         name.find("//") == std::string_view::npos;
}

void check_name(const CommandAttribute& name, CommandKind kind, bool is_carried) {
  const auto refuse = [&](std::string_view expected) {
    fail_at(name.where,
            "attribute \"name\": " + in_quotes(name.value) + " is not allowed, expected " + std::string(expected));
  };
  if (name.value.find_first_not_of(kSpaceCharacters) == std::string::npos) refuse("a name that is not empty");
  if (std::ranges::any_of(name.value, is_control)) refuse("a name without control characters");
  // Joints of robots, which become elements, have such names. Names of sensors become names of files.
  const bool has_folders = is_carried && is_name_with_folders(name.value);
  if (kind == CommandKind::sensor && !has_folders && name.value.find_first_of("./") != std::string::npos) {
    refuse("a name without '.' and '/'");
  }
}

// Reads the tag and its attributes, with the values of expressions. `kind` is unspecified unless the tag is a command.
Command read_tag(const pugi::xml_node& node, const SceneSource& source, const VariableValues& variables) {
  const std::string_view tag = node.name();
  if (!is_tag(tag)) {
    fail_at(place(node, source.text), "unknown command " + in_quotes(tag) + expected_command(tag));
  }
  Command command;
  const auto* const kind = std::ranges::find(kCommandTags, tag);
  if (kind != std::end(kCommandTags)) command.kind = static_cast<CommandKind>(kind - std::begin(kCommandTags));
  command.where = place(node, source.text);
  command.folder = source.folder;
  const std::vector<std::size_t> offsets = attribute_offsets(node, source.text.text());
  std::size_t i = 0;
  for (const pugi::xml_attribute& attribute : node.attributes()) {
    const Location where = i < offsets.size() ? source.text.at(offsets[i]) : command.where;
    ++i;
    if (command.find(attribute.name()) != nullptr) {
      fail_at(where, "attribute " + in_quotes(attribute.name()) + " is given twice, expected once");
    }
    command.attributes.push_back({attribute.name(), attribute.value(), where});
    const std::string wrong = substitute(command.attributes.back().value, variables);
    if (!wrong.empty()) fail_at(where, "attribute " + in_quotes(attribute.name()) + ": " + wrong);
  }
  return command;
}

// A <randomize/> is an element of this type with a name of its own.
void make_element(Command& randomize) {
  if (const CommandAttribute* const type = randomize.find("type")) {
    fail_at(type->where, "unknown attribute \"type\", expected none in <randomize/>");
  }
  const auto text = [&](const char* name) {
    const CommandAttribute* const found = randomize.find(name);
    return found == nullptr ? std::string() : found->value;
  };
  const std::string name = "randomize " + text("element") + "." + text("param");
  randomize.kind = CommandKind::element;
  randomize.attributes.push_back({"type", std::string(kRandomize), randomize.where});
  if (randomize.find("name") == nullptr) randomize.attributes.push_back({"name", name, randomize.where});
  if (randomize.find("insert_at") == nullptr) randomize.attributes.push_back({"insert_at", "ROOT", randomize.where});
}

void refuse_content(const pugi::xml_node& node, const SceneSource& source) {
  if (const pugi::xml_node child = node.first_child()) {
    const std::string_view tag = child.name(), name = node.attribute("name").value();
    std::string beside;
    if (is_tag(tag)) {
      beside =
          "; <" + std::string(tag) + "> stands beside it" + (name.empty() ? "" : ", with insert_at=" + in_quotes(name));
    }
    fail_at(place(child, source.text),
            "a command has no content, expected <" + std::string(node.name()) + " .../>" + beside);
  }
}

// The attribute of a statement that is no command.
const CommandAttribute& require(const Command& statement, std::string_view tag, std::string_view attribute) {
  if (const CommandAttribute* found = statement.find(attribute)) return *found;
  fail_at(statement.where, std::string(tag) + " without attribute " + in_quotes(attribute) + ", expected one");
}

[[noreturn]] void refuse_value(const CommandAttribute& attribute, std::string_view expected) {
  fail_at(attribute.where, "attribute " + in_quotes(attribute.name) + ": " + in_quotes(attribute.value) +
                               " is not allowed, expected " + std::string(expected));
}

// Returns the only element of the document if it is not a command but encloses commands.
pugi::xml_node find_root(const pugi::xml_document& document) {
  const pugi::xml_node first = document.first_child();
  const bool alone = first && !first.next_sibling() && first.type() == pugi::node_element;
  // An only element with attributes and without content is a misspelt command, and is reported as a command.
  const bool encloses = alone && (first.first_child() || !first.first_attribute());
  return encloses && !is_tag(first.name()) ? first : pugi::xml_node();
}

// Editors name the schema of a scene on its root.
bool names_schema(std::string_view attribute) {
  return attribute == "xmlns:xsi" || attribute == "xsi:noNamespaceSchemaLocation";
}

void check_root(const pugi::xml_node& root, const SceneSource& source) {
  const std::vector<std::size_t> offsets = attribute_offsets(root, source.text.text());
  std::size_t i = 0;
  for (const pugi::xml_attribute& attribute : root.attributes()) {
    if (!names_schema(attribute.name())) {
      fail_at(source.text.at(offsets.at(i)),
              "unknown attribute " + in_quotes(attribute.name()) + ", expected none on the root element");
    }
    ++i;
  }
}

[[noreturn]] void refuse_text(const pugi::xml_node& node, const SourceText& source) {
  std::string_view text = node.value();
  const std::size_t spaces = std::min(text.find_first_not_of(kSpaceCharacters), text.size());
  text = text.substr(spaces, text.find_last_not_of(kSpaceCharacters) + 1 - spaces);
  fail_at(source.at(static_cast<std::size_t>(node.offset_debug()) + spaces),
          "text " + in_quotes(text) + " between commands, expected commands only");
}

std::filesystem::path find_included_file(const Command& include) {
  const CommandAttribute& name = require(include, kInclude, "file");
  const std::filesystem::path path = include.folder / name.value;
  std::error_code error;
  if (!is_there(path)) fail_at(name.where, "there is no file " + in_quotes(path.string()));
  if (!is_input_file(path)) {
    fail_at(name.where, in_quotes(path.string()) + " is not a file, expected a scene file");
  }
  const std::filesystem::path canonical = std::filesystem::canonical(path, error);
  return error ? path : canonical;
}

void check_prefix(const CommandAttribute& prefix) {
  const auto is_wrong = [](char c) { return is_control(c) || c == '.'; };
  if (prefix.value.find_first_not_of(kSpaceCharacters) == std::string::npos || prefix.value.starts_with('/') ||
      std::ranges::any_of(prefix.value, is_wrong)) {
    refuse_value(prefix, "a text such as \"A/\", without '.', without control characters and without '/' in front");
  }
}

}  // namespace

SceneSource::SceneSource(SourceText source, std::filesystem::path from)
    : text(std::move(source)), folder(std::move(from)) {
  const std::string& xml = text.text();
  const pugi::xml_parse_result result =
      document.load_buffer(xml.data(), xml.size(), pugi::parse_default | pugi::parse_fragment, pugi::encoding_utf8);
  if (!result) fail_xml(text, result);
}

std::vector<Command> CommandReader::read(SourceText source, const std::filesystem::path& file,
                                         const std::filesystem::path& folder) {
  if (!file.empty()) {
    std::error_code error;
    const std::filesystem::path canonical = std::filesystem::canonical(file, error);
    open_.push_back(error ? file : canonical);
  }
  const SceneSource scene(std::move(source), folder);
  read_document(scene, nullptr);
  return std::move(commands_);
}

void CommandReader::read_document(const SceneSource& source, std::shared_ptr<const IncludeScope> scope) {
  const pugi::xml_node root = find_root(source.document);
  const std::string_view root_tag = root ? root.name() : "";
  for (const ModelFile& kind : kModelFiles) {
    if (root_tag != kind.root || (root_tag == "robot" && !root.child("link"))) continue;
    const std::string stem = std::filesystem::path(source.text.file()).stem().string();
    fail_at(place(root, source.text),
            "this is a " + std::string(kind.what) +
                ", expected a scene; put it into one: <part file=" + in_quotes(stem + std::string(kind.ending)) +
                " name=\"" + std::string(kind.name) + "\" insert_at=\"ROOT\"/>");
  }
  if (root) check_root(root, source);
  VariableValues variables;
  Block block{.source = source, .variables = variables, .scope = std::move(scope)};
  read_children(root ? root : source.document, block);
}

void CommandReader::read_children(const pugi::xml_node& parent, Block& block) {
  for (const pugi::xml_node& node : parent.children()) {
    if (node.type() != pugi::node_element) refuse_text(node, block.source.text);
    read_statement(node, block);
  }
}

void CommandReader::read_statement(const pugi::xml_node& node, Block& block) {
  count_step(node, block);
  Command command = read_tag(node, block.source, block.variables);
  if (node.name() == kRepeat) return read_repeat(node, command, block);
  refuse_content(node, block.source);
  if (node.name() == kSet) return read_set(command, block);
  if (node.name() == kInclude) return read_include(command, block);
  if (node.name() == kRandomize) make_element(command);
  if (const CommandAttribute* name = command.find("name")) check_name(*name, command.kind, is_carried_);
  command.scope = block.scope;
  commands_.push_back(std::move(command));
}

void CommandReader::count_step(const pugi::xml_node& node, const Block& block) {
  if (!block.repeated && block.scope == nullptr) return;
  std::size_t bytes = 0;
  for (const pugi::xml_attribute& attribute : node.attributes()) bytes += std::string_view(attribute.value()).size();
  steps_ += 1 + bytes / kStepBytes;
  if (steps_ <= kMaxSteps) return;
  fail_at(place(node, block.source.text), "repetitions and included files make more than " + std::to_string(kMaxSteps) +
                                              " commands, which is not allowed");
}

void CommandReader::read_set(const Command& set, Block& block) {
  const AttributeValues known(set, {}, kSetAttributes);
  const CommandAttribute& value = require(set, kSet, "value");
  double number = 0;
  if (!parse_number(value.value, number)) refuse_value(value, "a finite number or ${EXPRESSION}");
  define(require(set, kSet, "name"), number, block);
}

void CommandReader::define(const CommandAttribute& name, double value, Block& block) {
  if (!is_variable_name(name.value)) {
    refuse_value(name, "letters, digits and '_' without a digit in front, and not pi or the name of a function");
  }
  if (!block.variables.emplace(name.value, value).second) {
    fail_at(name.where, "the variable " + in_quotes(name.value) + " has a value already, expected a new name");
  }
  block.own.push_back(name.value);
}

void CommandReader::read_repeat(const pugi::xml_node& node, const Command& repeat, const Block& block) {
  const AttributeValues known(repeat, {}, kRepeatAttributes);
  require(repeat, kRepeat, "count");
  const CommandAttribute& as = require(repeat, kRepeat, "as");
  const std::int64_t count = AttributeValues(repeat, kRepeatRows, {}).integer("count");
  if (++repetitions_ > kMaxNested) {
    fail_at(repeat.where, "repetitions are nested deeper than " + std::to_string(kMaxNested));
  }
  for (std::int64_t i = 0; i < count; ++i) {
    Block round{.source = block.source, .variables = block.variables, .scope = block.scope, .repeated = true};
    count_step(node, round);
    define(as, static_cast<double>(i), round);
    read_children(node, round);
    for (const std::string& name : round.own) block.variables.erase(name);
  }
  --repetitions_;
}

void CommandReader::read_include(const Command& include, const Block& block) {
  const AttributeValues known(include, {}, kIncludeAttributes);
  if (check_include_) check_include_(require(include, kInclude, "file"), include.folder);
  const std::filesystem::path file = find_included_file(include);
  const CommandAttribute& name = require(include, kInclude, "file");
  const bool repeats = std::ranges::count(open_, file) > 0;
  open_.push_back(file);
  if (repeats || open_.size() > kMaxNested) {
    std::string chain;
    for (const std::filesystem::path& each : open_) chain += (chain.empty() ? "" : " > ") + each.filename().string();
    fail_at(name.where, in_quotes(name.value) +
                            (repeats ? " includes itself: "
                                     : " is included through more than " + std::to_string(kMaxNested) + " files: ") +
                            chain);
  }
  auto scope = std::make_shared<IncludeScope>();
  scope->outer = block.scope;
  if (block.scope != nullptr) scope->prefix = block.scope->prefix;
  if (const CommandAttribute* prefix = include.find("prefix")) {
    check_prefix(*prefix);
    scope->prefix += prefix->value;
  }
  if (const CommandAttribute* point = include.find("insert_at")) scope->root = *point;
  read_document(included(file, include.where), std::move(scope));
  open_.pop_back();
}

// Each file is parsed once for each place that includes it: the places of its commands name that place.
const SceneSource& CommandReader::included(const std::filesystem::path& file, const Location& where) {
  std::string from = to_string(where);
  if (where.included_from != nullptr) from += ", included from " + *where.included_from;
  std::unique_ptr<SceneSource>& source = included_[{file, from}];
  if (source == nullptr) {
    source = std::make_unique<SceneSource>(SourceText::read(file, from), file.parent_path());
    included_bytes_ += source->text.text().size();
  }
  if (included_bytes_ > kMaxIncludedBytes) {
    fail_at(where, "included files have more than " + std::to_string(kMaxIncludedBytes) + " bytes together");
  }
  return *source;
}

std::vector<Command> parse_commands(std::string_view xml, const std::string& file, const std::filesystem::path& folder,
                                    const FileCheck& check_include) {
  return CommandReader(false, check_include).read(SourceText(xml, file), {}, folder);
}

std::vector<Command> parse_carried_commands(std::string_view xml, const std::string& file,
                                            const std::filesystem::path& folder) {
  return CommandReader(true).read(SourceText(xml, file), {}, folder);
}

std::vector<Command> read_commands(const std::filesystem::path& file) {
  return CommandReader().read(SourceText::read(file), file, file.parent_path());
}

}  // namespace simvis
