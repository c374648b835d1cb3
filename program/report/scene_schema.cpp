#include "program/report/scene_schema.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include <simvis/element.h>
#include <simvis/sensor.h>
#include <simvis/version.h>
#include "engine/base/words.h"
#include "program/report/command_reference.h"
#include "scenegraph/language/command_tags.h"
#include "scenegraph/language/pose_attribute.h"

namespace simvis {
namespace {

/// The value types that attributes share. A number is what std::from_chars() reads: without '+', INF and NaN.
constexpr std::string_view kSharedTypes = R"(
  <xs:simpleType name="expression">
    <xs:annotation><xs:documentation>A text with ${EXPRESSION}.</xs:documentation></xs:annotation>
    <xs:restriction base="xs:string"><xs:pattern value=".*$\{.*\}.*"/></xs:restriction>
  </xs:simpleType>
  <xs:simpleType name="number">
    <xs:restriction base="xs:double">
      <xs:pattern value="-?([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][\-+]?[0-9]+)?"/>
      <xs:minInclusive value="-1.7976931348623157E308"/><xs:maxInclusive value="1.7976931348623157E308"/>
    </xs:restriction>
  </xs:simpleType>
  <xs:simpleType name="integer">
    <xs:restriction base="xs:long"><xs:pattern value="-?[0-9]+"/></xs:restriction>
  </xs:simpleType>
  <xs:simpleType name="numbers"><xs:list itemType="number"/></xs:simpleType>
  <xs:simpleType name="text">
    <xs:restriction base="xs:string"><xs:pattern value="\s*\S[\s\S]*"/></xs:restriction>
  </xs:simpleType>
  <xs:simpleType name="position"><xs:restriction base="numbers"><xs:length value="3"/></xs:restriction></xs:simpleType>
  <xs:simpleType name="placement"><xs:restriction base="numbers"><xs:length value="6"/></xs:restriction></xs:simpleType>
  <xs:simpleType name="pose"><xs:union memberTypes="position placement"/></xs:simpleType>
  <xs:simpleType name="quaternion"><xs:restriction base="numbers"><xs:length value="4"/></xs:restriction></xs:simpleType>
  <xs:simpleType name="variable">
    <xs:restriction base="xs:string"><xs:pattern value="[A-Za-z_][A-Za-z0-9_]*"/></xs:restriction>
  </xs:simpleType>
  <xs:simpleType name="prefix">
    <xs:restriction base="text"><xs:pattern value="[^/.][^.]*"/></xs:restriction>
  </xs:simpleType>
  <xs:simpleType name="sensor_name">
    <xs:restriction base="text"><xs:pattern value="[^/.]*"/></xs:restriction>
  </xs:simpleType>
  <xs:simpleType name="frame">
    <xs:restriction base="xs:string"><xs:pattern value="[^\s/]\S*"/></xs:restriction>
  </xs:simpleType>
  <xs:simpleType name="topic">
    <xs:restriction base="xs:token"><xs:pattern value="([^:]|:[^=])+:=(/[A-Za-z_][A-Za-z0-9_]*)+"/></xs:restriction>
  </xs:simpleType>
  <xs:simpleType name="topics"><xs:list itemType="topic"/></xs:simpleType>
)";

/// Attributes whose kind is a text, with a form that the reader checks. An empty tag stands for all.
struct TextForm {
  std::string_view tag, attribute, type;
};
constexpr std::array kTextForms{
    TextForm{"", kPoseOffset, "pose"},         TextForm{"", kQuaternion, "quaternion"},
    TextForm{"sensor", "name", "sensor_name"}, TextForm{"sensor", "frame", "frame"},
    TextForm{"sensor", "topics", "topics"},    TextForm{kSet, "name", "variable"},
    TextForm{kRepeat, "as", "variable"},       TextForm{kInclude, "prefix", "prefix"},
};

/// A row of a command (`type` is empty) or of a type of elements or sensors.
struct SchemaRow {
  AttributeSpec spec;
  std::string_view type;
};

/// All rows of a command that have the same name.
struct SchemaAttribute {
  std::string_view name;
  bool required = false;
  std::vector<SchemaRow> rows{};
};

std::string in_xml(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string documentation(std::string_view text) {
  return "<xs:annotation><xs:documentation>" + in_xml(text) + "</xs:documentation></xs:annotation>";
}

std::string restriction(std::string_view base, std::string_view facets) {
  return "<xs:simpleType><xs:restriction base=\"" + std::string(base) + "\">" + std::string(facets) +
         "</xs:restriction></xs:simpleType>";
}

std::string facet(std::string_view name, std::string_view value) {
  return "<xs:" + std::string(name) + " value=\"" + in_xml(value) + "\"/>";
}

/// A limit of a row; XML Schema writes integers without an exponent.
std::string limit_text(const AttributeSpec& spec, double limit) {
  return spec.kind == AttributeKind::integer ? std::to_string(static_cast<std::int64_t>(limit)) : format_number(limit);
}

std::string limits(const AttributeSpec& spec) {
  std::string facets;
  if (spec.min != -kNoLimit) {
    facets += facet(spec.open_min ? "minExclusive" : "minInclusive", limit_text(spec, spec.min - spec.rounding));
  }
  if (spec.max != kNoLimit) {
    facets += facet(spec.open_max ? "maxExclusive" : "maxInclusive", limit_text(spec, spec.max + spec.rounding));
  }
  return facets;
}

std::string words_type(std::string_view choices) {
  std::string facets;
  for (const std::string_view word : words_of(choices)) facets += facet("enumeration", word);
  return restriction("xs:token", facets);
}

/// One or more values of the type, or `length` values.
std::string list_type(const std::string& item, std::size_t length) {
  return "<xs:simpleType><xs:restriction><xs:simpleType><xs:list>" + item + "</xs:list></xs:simpleType>" +
         (length == 0 ? facet("minLength", "1") : facet("length", std::to_string(length))) +
         "</xs:restriction></xs:simpleType>";
}

std::string value_type(const AttributeSpec& spec) {
  constexpr std::size_t kVectorLength = 3;
  switch (spec.kind) {
    case AttributeKind::number:
      return restriction("number", limits(spec));
    case AttributeKind::integer:
      return restriction("integer", limits(spec));
    case AttributeKind::choice:
      return words_type(spec.choices);
    case AttributeKind::flags:
      return list_type(words_type(spec.choices), 0);
    case AttributeKind::vector:
      return list_type(restriction("number", limits(spec)), kVectorLength);
    case AttributeKind::text:
    case AttributeKind::part:
    case AttributeKind::object:
    case AttributeKind::objects:
    case AttributeKind::element:
    case AttributeKind::sensor:
    case AttributeKind::file:
      break;
  }
  return restriction("text", "");
}

/// The types of elements or of sensors, each with its summary.
template <typename Types>
std::string type_names(const Types& types) {
  std::string facets;
  for (const auto* const type : types) {
    facets += "\n        <xs:enumeration value=\"" + in_xml(type->name) + "\">" + documentation(type->summary) +
              "</xs:enumeration>";
  }
  return restriction("xs:token", facets + "\n      ");
}

std::string value_type(std::string_view tag, const SchemaRow& row) {
  if (!row.type.empty()) return value_type(row.spec);
  if (row.spec.name == "type" && tag == "element") return type_names(element_types());
  if (row.spec.name == "type" && tag == "sensor") return type_names(sensor_types());
  for (const TextForm& form : kTextForms) {
    if ((form.tag.empty() || form.tag == tag) && form.attribute == row.spec.name) return restriction(form.type, "");
  }
  return value_type(row.spec);
}

/// What the row means, with its unit and its default.
std::string meaning(const AttributeSpec& spec) {
  std::string facts;
  const auto add = [&](std::string_view fact) { facts += (facts.empty() ? "" : "; ") + std::string(fact); };
  if (!spec.unit.empty()) add(spec.unit);
  if (!spec.default_value.empty()) add("default " + std::string(spec.default_value));
  if (spec.live) add("a parameter that can change while the scene runs");
  return std::string(spec.text) + (facts.empty() ? "" : " (" + facts + ")");
}

/// The meaning of each row, followed by the types that share it.
std::string documentation(const SchemaAttribute& attribute) {
  std::vector<std::pair<std::string, std::string>> meanings;
  for (const SchemaRow& row : attribute.rows) {
    const std::string text = meaning(row.spec);
    auto found = std::ranges::find(meanings, text, &std::pair<std::string, std::string>::first);
    if (found == meanings.end()) found = meanings.insert(meanings.end(), {text, ""});
    if (!row.type.empty()) found->second += (found->second.empty() ? "" : ", ") + std::string(row.type);
  }
  std::string text;
  for (const auto& [line, types] : meanings) {
    text += (text.empty() ? "" : "\n") + line + (types.empty() ? "" : ". Of: " + types);
  }
  return documentation(text);
}

std::string element_of(std::string_view tag, const SchemaAttribute& attribute) {
  std::vector<std::string> types;
  for (const SchemaRow& row : attribute.rows) {
    std::string type = value_type(tag, row);
    if (std::ranges::count(types, type) == 0) types.push_back(std::move(type));
  }
  std::string text = "    <xs:attribute name=\"" + std::string(attribute.name) + "\"" +
                     (attribute.required ? " use=\"required\">" : ">") + documentation(attribute) +
                     "\n      <xs:simpleType><xs:union memberTypes=\"expression\">";
  for (const std::string& type : types) text += type;
  return text + "</xs:union></xs:simpleType>\n    </xs:attribute>\n";
}

void add_rows(std::vector<SchemaAttribute>& attributes, AttributeTable table, std::string_view type) {
  for (const AttributeSpec& spec : table) {
    auto found = std::ranges::find(attributes, spec.name, &SchemaAttribute::name);
    if (found == attributes.end()) found = attributes.insert(attributes.end(), {.name = spec.name});
    found->rows.push_back({spec, type});
  }
}

std::vector<SchemaAttribute> attributes_of(const CommandForm& form) {
  std::vector<SchemaAttribute> attributes;
  add_rows(attributes, form.attributes, "");
  if (form.name == "element") {
    for (const ElementType* const type : element_types()) add_rows(attributes, type->attributes, type->name);
  }
  if (form.name == "sensor") {
    for (const SensorType* const type : sensor_types()) add_rows(attributes, all_attributes(*type), type->name);
  }
  for (SchemaAttribute& attribute : attributes) attribute.required = std::ranges::count(form.required, attribute.name);
  return attributes;
}

std::string declaration(const CommandForm& form) {
  std::string attributes;
  for (const SchemaAttribute& each : attributes_of(form)) attributes += element_of(form.name, each);
  if (form.name == kRepeat) {
    attributes = "    <xs:complexContent><xs:extension base=\"commands\">\n" + attributes +
                 "    </xs:extension></xs:complexContent>\n";
  }
  return "  <xs:element name=\"" + std::string(form.name) + "\">" + documentation(form.summary) + "<xs:complexType>\n" +
         attributes + "  </xs:complexType></xs:element>\n";
}

}  // namespace

std::string scene_schema() {
  const std::vector<CommandForm> forms = command_forms();
  std::string references, declarations;
  for (const CommandForm& form : forms) {
    references += "    <xs:element ref=\"" + std::string(form.name) + "\"/>\n";
    declarations += declaration(form);
  }
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<xs:schema xmlns:xs=\"http://www.w3.org/2001/XMLSchema\">\n  " +
         documentation("The scene language of SimVis " + std::string(version()) +
                       ". Generated: simvis-run --describe all --xsd") +
         std::string(kSharedTypes) +
         "  <xs:complexType name=\"commands\"><xs:choice minOccurs=\"0\" maxOccurs=\"unbounded\">\n" + references +
         "  </xs:choice></xs:complexType>\n  <xs:element name=\"simvis\" type=\"commands\">" +
         documentation("A scene: its commands are executed in order.") + "</xs:element>\n" + declarations +
         "</xs:schema>\n";
}

}  // namespace simvis
