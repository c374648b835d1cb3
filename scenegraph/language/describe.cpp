#include <algorithm>
#include <utility>
#include <vector>

#include <simvis/attributes.h>
#include "engine/base/words.h"
#include "scenegraph/language/markdown.h"
#include "scenegraph/language/text_table.h"

namespace simvis {
namespace {

TextRow heads() { return {"name", "kind", "default", "unit", "allowed", "live", "meaning"}; }

// "0 < . < 180", "0 .. 10", "> 0", or the choices.
std::string allowed_text(const AttributeSpec& spec) {
  if (!spec.choices.empty() && spec.kind != AttributeKind::file) {
    std::string text(spec.choices);
    std::ranges::replace(text, ' ', '|');
    return text;
  }
  const bool has_min = spec.min != -kNoLimit, has_max = spec.max != kNoLimit;
  const std::string min = (spec.open_min ? "> " : ">= ") + format_number(spec.min);
  const std::string max = (spec.open_max ? "< " : "<= ") + format_number(spec.max);
  if (has_min && has_max) return min + ", " + max;
  return has_min ? min : has_max ? max : "";
}

// The kind with the unit, the allowed values and the default: "number (deg), > 0, < 180, default 60".
std::string facts_of(const AttributeSpec& spec) {
  std::string facts(kind_text(spec.kind));
  const bool has_words = spec.kind == AttributeKind::choice || spec.kind == AttributeKind::flags;
  if (has_words) facts = spec.kind == AttributeKind::choice ? "one of " : "one or more of ";
  std::string_view separator = has_words ? "" : ", ";
  if (!spec.unit.empty()) facts += " (" + std::string(spec.unit) + ")";
  const std::string allowed = allowed_text(spec);
  for (const std::string_view each : words_of(allowed, "|")) {
    facts += std::string(separator) + std::string(each);
    separator = ", ";
  }
  if (!spec.default_value.empty()) facts += ", default " + std::string(spec.default_value);
  return spec.live ? facts + ", live" : facts;
}

TextRow row_of(const AttributeSpec& spec) {
  return {std::string(spec.name),
          std::string(kind_text(spec.kind)),
          std::string(spec.default_value),
          std::string(spec.unit),
          allowed_text(spec),
          spec.live ? "yes" : "",
          std::string(spec.text)};
}

void add_notes(std::string& page, std::string_view notes) {
  while (!notes.empty()) {
    const std::size_t end = std::min(notes.find('\n'), notes.size());
    page += '\n';
    add_wrapped(page, "", 0, notes.substr(0, end));
    notes.remove_prefix(std::min(end + 1, notes.size()));
  }
}

}  // namespace

std::string_view kind_text(AttributeKind kind) {
  switch (kind) {
    case AttributeKind::number:
      return "number";
    case AttributeKind::integer:
      return "integer";
    case AttributeKind::choice:
      return "choice";
    case AttributeKind::flags:
      return "flags";
    case AttributeKind::text:
      return "text";
    case AttributeKind::file:
      return "file";
    case AttributeKind::part:
      return "part";
    case AttributeKind::object:
      return "object";
    case AttributeKind::objects:
      return "objects";
    case AttributeKind::element:
      return "element";
    case AttributeKind::sensor:
      return "sensor";
    case AttributeKind::vector:
      return "3 numbers";
  }
  return "";
}

std::string describe(std::string_view type, std::string_view summary, AttributeTable table, std::string_view notes) {
  std::string page;
  add_wrapped(page, "", 0, std::string(type) + ": " + std::string(summary));
  add_notes(page, notes);
  if (table.empty()) return page;
  std::vector<TextRow> rows;
  for (const AttributeSpec& spec : table) {
    rows.push_back({std::string(spec.name), facts_of(spec)});
    rows.push_back({"", std::string(spec.text)});
  }
  page += "\n" + text_table(rows);
  if (std::ranges::any_of(table, &AttributeSpec::live)) {
    page += "\nlive: a parameter, ELEMENT.NAME, that can change while the scene runs\n";
  }
  return page;
}

std::string markdown_text(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '|' || c == '*' || c == '<' || c == '[') escaped += '\\';
    escaped += c;
  }
  return escaped;
}

std::string markdown_table(AttributeTable table) {
  if (table.empty()) return "";
  std::vector<TextRow> rows;
  for (const AttributeSpec& spec : table) {
    TextRow row = row_of(spec);
    for (std::size_t c = 1; c < row.size(); ++c) row[c] = markdown_text(row[c]);
    row[0] = '`' + row[0] + '`';
    rows.push_back(std::move(row));
  }
  return markdown_rows(heads(), rows);
}

}  // namespace simvis
