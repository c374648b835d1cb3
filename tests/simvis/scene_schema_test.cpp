// The XML schema of the scene language against the reader of scenes. xmllint validates by the schema.
//
// The axes: each type x each attribute x values that its row takes and values that it does not, and misspelt names;
// whole documents; every scene in the tree, in the documents and in the tests.
#include <doctest/doctest.h>

#include <array>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include <simvis/element.h>
#include <simvis/scene.h>
#include <simvis/sensor.h>
#include "engine/base/words.h"
#include "program/report/scene_schema.h"
#include "scenegraph/language/command_attributes.h"
#include "scenegraph/language/command_reader.h"
#include "scenegraph/language/row_names.h"
#include "simvis/ros/sensor_topics.h"
#include "tests/support/markdown.h"
#include "tests/support/simvis_run.h"
#include "tests/support/skip.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

namespace fs = std::filesystem;

bool lacks_xmllint() {
  if (fs::exists("/usr/bin/xmllint")) return false;
  test::skip("xmllint is not installed (Debian's libxml2-utils)");
  return true;
}

constexpr auto kPartNames = names_of(kPartCommonRows);
constexpr auto kRemoveNames = names_of(kRemoveCommonRows);

void require_all(const Command& command, std::initializer_list<const char*> names) {
  for (const char* name : names) command.require(name);
}

/// What the reader checks of a command before it looks at the scene and at files.
void check_alone(const Command& command) {
  if (command.kind == CommandKind::remove) {
    command.require("name");
    AttributeValues(command, kRemoveRows, kRemoveNames);
    return;
  }
  require_all(command, {"name", "insert_at"});
  for (const char* reference : {"insert_at", "look_at", "file"}) {  // no part and no file has a name of blanks
    const CommandAttribute* const given = command.find(reference);
    if (given != nullptr && trimmed(given->value).empty()) throw InputError("nothing has this name");
  }
  pose_offset(command);
  if (command.kind == CommandKind::part) {
    AttributeValues(command, Scene::part_attributes(), kPartNames);
    return;
  }
  const std::string& type = command.require("type").value;
  if (command.kind == CommandKind::element) {
    const ElementType* const element = find_element_type(type);
    if (element == nullptr) throw InputError("no such type");
    AttributeValues(command, element->attributes, kElementCommonAttributes);
    return;
  }
  const SensorType* const sensor = find_sensor_type(type);
  if (sensor == nullptr) throw InputError("no such type");
  check_message_names(command);
  AttributeValues(command, all_attributes(*sensor), kSensorCommonAttributes);
}

bool reader_takes(const std::string& xml) {
  try {
    for (const Command& command : parse_commands(xml, "scene.xml", "/")) check_alone(command);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

std::string schema_file(const TemporaryFolder& folder) {
  write_text(folder / "simvis.xsd", scene_schema());
  return (folder / "simvis.xsd").string();
}

/// The numbers of the lines, from 1, that are no valid commands.
std::set<std::size_t> refused_lines(const TemporaryFolder& folder, const Strings& commands) {
  std::string scene = "<simvis>";
  for (const std::string& command : commands) scene += command + "\n";
  write_text(folder / "scene.xml", scene + "</simvis>\n");
  const std::string file = (folder / "scene.xml").string();
  const ProcessResult result = Process({"xmllint", "--noout", "--schema", schema_file(folder), file}).wait();
  INFO(result.err.substr(0, 300));
  CHECK((result.exit_code == 0 || result.exit_code == 3));
  std::set<std::size_t> refused;
  std::istringstream lines(result.err);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(file + ":")) refused.insert(std::stoul(line.substr(file.size() + 1)));
  }
  return refused;
}

/// Which of these documents are valid, by their index.
std::vector<bool> valid_documents(const TemporaryFolder& folder, const Strings& documents) {
  Strings arguments{"xmllint", "--noout", "--schema", schema_file(folder)};
  for (std::size_t i = 0; i < documents.size(); ++i) {
    arguments.push_back((folder / ("document_" + std::to_string(i) + ".xml")).string());
    write_text(arguments.back(), documents[i]);
  }
  const std::string said = Process(arguments).wait().err;
  std::vector<bool> valid;
  for (std::size_t i = 0; i < documents.size(); ++i) {
    valid.push_back(said.find("document_" + std::to_string(i) + ".xml validates\n") != said.npos);
  }
  return valid;
}

std::string equals(std::string_view value) { return "='" + std::string(value) + "'"; }

/// Values at, within and beyond the limits of a row, and texts that are none.
Strings numbers_to_try(const AttributeSpec& spec) {
  const bool whole = spec.kind == AttributeKind::integer;
  const auto text = [&](double value) {
    return whole ? std::to_string(static_cast<std::int64_t>(value)) : format_number(value);
  };
  const double step = whole ? 1 : 0.5, min = spec.min == -kNoLimit ? -1e6 : spec.min,
               max = spec.max == kNoLimit ? std::max(min, 0.0) + 1e6 : spec.max;
  return {text(min),
          text(max),
          text(min + std::min(step, (max - min) / 2)),
          text(min - step),
          text(max + step),
          "0",
          "1",
          "-1",
          "1.5",
          " 1 ",
          "",
          " ",
          "x",
          "1 2",
          "+1",
          "1.",
          ".5",
          "1e3",
          "1e999",
          "nan",
          "inf",
          "INF",
          "NaN",
          "0x10",
          "99999999999999999999"};
}

Strings values_to_try(const AttributeSpec& spec) {
  Strings values;
  switch (spec.kind) {
    case AttributeKind::number:
    case AttributeKind::integer:
      return numbers_to_try(spec);
    case AttributeKind::vector:
      for (const std::string& number : numbers_to_try(spec)) values.push_back(number + " 1 " + number);
      for (const char* other : {"1 2", "1 2 3 4", "1,2,3", ""}) values.emplace_back(other);
      return values;
    case AttributeKind::choice:
    case AttributeKind::flags:
      for (const std::string_view word : words_of(spec.choices)) values.emplace_back(word);
      for (const char* other : {"", "nonsense", " "}) values.emplace_back(other);
      values.emplace_back(spec.choices);
      values.push_back(values.front() + " nonsense");
      values.push_back(values.front() + "," + values.back());
      return values;
    default:
      return {"A", "A B", "", " ", "1"};
  }
}

/// A command with one attribute beside those that it needs.
struct Tried {
  std::string tag, type, attribute, value;
  std::string xml(std::string_view other_type) const {
    std::string text = "<" + tag;
    if (!other_type.empty() && attribute != "type") text += " type" + equals(other_type);
    for (const char* name : {"name", "insert_at"}) {
      if (attribute != name) text += std::string(" ") + name + equals("A");
    }
    return text + " " + attribute + equals(value) + "/>";
  }
};

void add_tries(std::vector<Tried>& tries, const std::string& tag, std::string_view type, AttributeTable rows) {
  for (const AttributeSpec& spec : rows) {
    for (std::string& value : values_to_try(spec)) {
      tries.push_back({tag, std::string(type), std::string(spec.name), std::move(value)});
    }
    tries.push_back({tag, std::string(type), std::string(spec.name), "${1/2}"});
    tries.push_back({tag, std::string(type), std::string(spec.name) + "x", "1"});
  }
}

std::vector<Tried> all_tries() {
  std::vector<Tried> tries;
  add_tries(tries, "part", "", kPartCommonRows);
  add_tries(tries, "part", "", Scene::part_attributes());
  add_tries(tries, "element", "pose", kElementCommonRows);
  for (const ElementType* const type : element_types()) add_tries(tries, "element", type->name, type->attributes);
  add_tries(tries, "sensor", "imu", kSensorCommonRows);
  for (const SensorType* const type : sensor_types()) add_tries(tries, "sensor", type->name, all_attributes(*type));
  for (const char* pose : {"1 2 3 4 5 6", "1 2", "1 2 3 4 5 6 7", "1 2 3 4 5 x"}) {
    for (const char* tag : {"part", "sensor"}) tries.push_back({tag, "imu", "pose_offset", pose});
  }
  for (const char* quaternion : {"1 0 0 0", "1 0 0", "1 0 0 0 0"})
    tries.push_back({"sensor", "imu", "quaternion", quaternion});
  for (const char* frame : {"map", "/map", "a map", "a/map"}) tries.push_back({"sensor", "imu", "frame", frame});
  for (const char* topics :
       {"a:=/b", "*:=/b", "a:=/b c:=/d/e1", "a", "a=/b", "a:=b", ":=/b", "a:=b:=/c", "a:=/1", "a:=/b/"}) {
    tries.push_back({"sensor", "imu", "topics", topics});
  }
  for (const char* name : {"A.B", "A/B", "A B", "1"}) tries.push_back({"sensor", "imu", "name", name});
  for (Tried& each : tries) {
    if (each.tag == "part") each.type.clear();
  }
  return tries;
}

/// Whether another type of the same command takes the attribute: a schema knows no types.
bool other_type_takes(const Tried& tried) {
  if (tried.tag == "element") {
    return std::ranges::any_of(element_types(),
                               [&](const ElementType* type) { return reader_takes(tried.xml(type->name)); });
  }
  return tried.tag == "sensor" && std::ranges::any_of(sensor_types(), [&](const SensorType* type) {
           return reader_takes(tried.xml(type->name));
         });
}

/// The raw texts of a source file of the tests.
Strings raw_texts(const std::string& source) {
  Strings texts;
  for (std::size_t at = source.find("R\"("); at != source.npos; at = source.find("R\"(", at + 1)) {
    const std::size_t end = source.find(")\"", at);
    if (end != source.npos) texts.push_back(source.substr(at + 3, end - at - 3));
  }
  return texts;
}

/// Scenes, and pieces of scenes, of tests and documents.
Strings scenes_in_texts() {
  Strings texts;
  const fs::path root = SIMVIS_SOURCE_DIR;
  for (const auto& entry : fs::recursive_directory_iterator(root / "tests")) {
    const fs::path& file = entry.path();
    if (file.extension() != ".cpp" && file.extension() != ".h") continue;
    for (std::string& text : raw_texts(read_text(file))) texts.push_back(std::move(text));
  }
  for (const fs::path& page : documentation_pages()) {
    for (const MarkdownBlock& block : markdown_blocks(page)) {
      if (block.language == "xml") texts.push_back(block.text);
    }
  }
  return texts;
}

}  // namespace

TEST_CASE("the rows of elements and sensors have each attribute that the reader knows") {
  const auto names = [](AttributeTable rows) {
    std::set<std::string_view> all;
    for (const AttributeSpec& spec : rows) all.insert(spec.name);
    return all;
  };
  CHECK(names(kElementCommonRows) ==
        std::set<std::string_view>(std::begin(kElementCommonAttributes), std::end(kElementCommonAttributes)));
  CHECK(names(kSensorCommonRows) ==
        std::set<std::string_view>(std::begin(kSensorCommonAttributes), std::end(kSensorCommonAttributes)));
}

TEST_CASE("the schema and the reader take the same attributes of each type") {
  if (lacks_xmllint()) return;
  const TemporaryFolder folder;
  const std::vector<Tried> tries = all_tries();
  Strings commands;
  for (const Tried& each : tries) commands.push_back(each.xml(each.type));
  const std::set<std::size_t> refused = refused_lines(folder, commands);
  int both = 0, none = 0, by_type = 0;
  for (std::size_t i = 0; i < tries.size(); ++i) {
    const bool schema = !refused.contains(i + 1), reader = reader_takes(commands[i]);
    if (schema && !reader) {
      const bool is_expression = tries[i].value.starts_with("${");
      CHECK_MESSAGE((is_expression || other_type_takes(tries[i])), commands[i]);
      ++by_type;
    } else {
      CHECK_MESSAGE(schema == reader, commands[i]);
      ++(reader ? both : none);
    }
  }
  MESSAGE(both << " taken, " << none << " refused by both, " << by_type << " depend on the type");
  CHECK(both > 5000);
  CHECK(none > 5000);
}

TEST_CASE("the schema and the reader take the same documents") {
  if (lacks_xmllint()) return;
  const TemporaryFolder folder;
  const Strings documents = {
      "<simvis/>",
      "<simvis></simvis>",
      "<?xml version='1.0'?><?xml-model href='simvis.xsd'?><simvis><!-- none --></simvis>",
      "<simvis xmlns:xsi='http://www.w3.org/2001/XMLSchema-instance' xsi:noNamespaceSchemaLocation='simvis.xsd'>"
      "<part name='A' insert_at='ROOT'/></simvis>",
      "<simvis name='A'><part name='A' insert_at='ROOT'/></simvis>",
      "<simvis name='A'/>",
      "<simvis>text</simvis>",
      "<part name='A' insert_at='ROOT'/>",
      "<part name='A'/>",
      "<part insert_at='ROOT'/>",
      "<prt name='A' insert_at='ROOT'/>",
      "<simvis><part name='A' insert_at='ROOT'><sensor type='imu' name='B' insert_at='A'/></part></simvis>",
      "<simvis><sensor name='A' insert_at='ROOT'/></simvis>",
      "<simvis><sensor type='imx' name='A' insert_at='ROOT'/></simvis>",
      "<simvis><sensor type='pose' name='A' insert_at='ROOT'/></simvis>",
      "<simvis><element type='pose' name='A' insert_at='ROOT' pose_offset='0 0 0 0 0 0'/></simvis>",
      "<simvis><set name='a' value='1'/><repeat count='2' as='i'><part name='P${i}' "
      "insert_at='ROOT'/></repeat></simvis>",
      "<simvis><set name='1a' value='1'/></simvis>",
      "<simvis><set name='a' value='one'/></simvis>",
      "<simvis><set name='a'/></simvis>",
      "<simvis><set value='1'/></simvis>",
      "<simvis><repeat count='2' as='i'/></simvis>",
      "<simvis><repeat count='2'/></simvis>",
      "<simvis><repeat as='i'/></simvis>",
      "<simvis><repeat count='-1' as='i'/></simvis>",
      "<simvis><repeat count='2' as='i'>text</repeat></simvis>",
      "<simvis><repeat count='2' as='i'><repeat count='2' as='j'><prt/></repeat></repeat></simvis>",
      "<simvis><include/></simvis>",
      "<simvis><remove name='A'/><remove name='A' kind='part'/></simvis>",
      "<simvis><remove/></simvis>",
      "<simvis><remove name='A' kind='robot'/></simvis>",
      "<simvis><randomize element='A' param='x' min='0' max='1'/></simvis>",
      "<simvis><randomize element='A' param='x' min='0' max='1' type='randomize'/></simvis>",
  };
  const std::vector<bool> valid = valid_documents(folder, documents);
  for (std::size_t i = 0; i < documents.size(); ++i)
    CHECK_MESSAGE(valid[i] == reader_takes(documents[i]), documents[i]);
  CHECK(std::ranges::count(valid, true) > 8);
}

TEST_CASE("scenes of the tree, of documents and of tests that the reader takes are valid") {
  if (lacks_xmllint()) return;
  const TemporaryFolder folder;
  Strings documents, pieces = scenes_in_texts();
  for (const char* where : {"scenes", "python/examples"}) {
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(SIMVIS_SOURCE_DIR) / where)) {
      if (entry.path().extension() == ".xml") documents.push_back(read_text(entry.path()));
    }
  }
  CHECK(documents.size() >= 8);
  for (const std::string& piece : pieces) {
    const bool has_root = piece.find("<simvis>") != piece.npos;
    const std::string scene = has_root ? piece : "<simvis>" + piece + "</simvis>";
    const bool has_command = std::regex_search(scene, std::regex("<(part|sensor|element) "));
    if (has_command && reader_takes(scene)) documents.push_back(scene.substr(scene.find('<')));
  }
  MESSAGE(documents.size() << " scenes");
  CHECK(documents.size() > 300);
  const std::vector<bool> valid = valid_documents(folder, documents);
  for (std::size_t i = 0; i < documents.size(); ++i) CHECK_MESSAGE(valid[i], documents[i]);
}

TEST_CASE("--xsd prints the schema with the types of plug-ins, of all types alone") {
  const std::string plugin = tested_build() + "/lib/libsimvis_example_plugin.so";
  const ProcessResult schema = run_simvis({"--plugin", plugin, "--describe", "all", "--xsd"});
  CHECK(schema.exit_code == 0);
  CHECK(schema.out.find("<xs:enumeration value=\"plate\">") != schema.out.npos);
  CHECK(run_simvis({"--describe", "camera", "--xsd"}).err.find("expected --describe all") != std::string::npos);
}

}  // namespace simvis

TEST_SUITE_END();
