#include <algorithm>
#include <array>

#include <simvis/attributes.h>
#include "scenegraph/language/markdown.h"

namespace simvis {
namespace {

constexpr std::size_t kWidth = 120;
constexpr std::size_t kNarrowestText = 30;
constexpr std::size_t kColumns = 6;  // columns before the text
using Row = std::array<std::string, kColumns>;
constexpr std::string_view kHeads[kColumns] = {"name", "kind", "default", "unit", "allowed", "live"};

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
    case AttributeKind::part:
      return "part";
    case AttributeKind::element:
      return "element";
    case AttributeKind::sensor:
      return "sensor";
    case AttributeKind::vector:
      return "3 numbers";
  }
  return "";
}

// "0 < . < 180", "0 .. 10", "> 0", or the choices.
std::string allowed_text(const AttributeSpec& spec) {
  if (!spec.choices.empty()) {
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

void pad(std::string& line, std::size_t width) { line.resize(std::max(line.size(), width), ' '); }

void end_line(std::string& page, std::string line) {
  line.erase(line.find_last_not_of(' ') + 1);
  page += line + "\n";
}

Row row_of(const AttributeSpec& spec) {
  return {std::string(spec.name),
          std::string(kind_text(spec.kind)),
          std::string(spec.default_value),
          std::string(spec.unit),
          allowed_text(spec),
          spec.live ? "yes" : ""};
}

// Adds `line` and then `text`, wrapped between words. Continuation lines are indented by `indent`.
void add_text(std::string& page, std::string line, std::size_t indent, std::string_view text) {
  const std::size_t room = std::max(kWidth - std::min(kWidth, indent), kNarrowestText);
  while (text.size() > room) {
    std::size_t cut = text.rfind(' ', room);
    if (cut == std::string_view::npos) cut = std::min(text.find(' '), text.size());
    end_line(page, line + std::string(text.substr(0, cut)));
    text.remove_prefix(std::min(cut + 1, text.size()));
    line.assign(indent, ' ');
  }
  end_line(page, line + std::string(text));
}

// Adds one row to the page. The text column wraps within its own column.
void add_row(std::string& page, const Row& row, const std::array<std::size_t, kColumns>& widths,
             std::string_view text) {
  std::string line;
  std::size_t indent = 0;
  for (std::size_t c = 0; c < kColumns; ++c) {
    line += row[c];
    indent += widths[c] + 2;
    pad(line, indent);
  }
  add_text(page, line, indent, text);
}

void add_notes(std::string& page, std::string_view notes) {
  while (!notes.empty()) {
    const std::size_t end = std::min(notes.find('\n'), notes.size());
    page += '\n';
    add_text(page, "", 0, notes.substr(0, end));
    notes.remove_prefix(std::min(end + 1, notes.size()));
  }
}

}  // namespace

std::string describe(std::string_view type, std::string_view summary, AttributeTable table, std::string_view notes) {
  std::string page;
  add_text(page, "", 0, std::string(type) + ": " + std::string(summary));
  add_notes(page, notes);
  if (table.empty()) return page;
  std::vector<Row> rows{Row()};
  std::ranges::copy(kHeads, rows[0].begin());
  for (const AttributeSpec& spec : table) rows.push_back(row_of(spec));
  std::array<std::size_t, kColumns> widths{};
  for (const Row& row : rows) {
    for (std::size_t c = 0; c < kColumns; ++c) widths[c] = std::max(widths[c], row[c].size());
  }
  page += "\n";
  add_row(page, rows[0], widths, "meaning");
  for (std::size_t i = 0; i < table.size(); ++i) add_row(page, rows[i + 1], widths, table[i].text);
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
  std::string page = "|", rule = "|";
  for (const std::string_view head : kHeads) {
    page += ' ' + std::string(head) + " |";
    rule += "---|";
  }
  page += " meaning |\n" + rule + "---|\n";
  for (const AttributeSpec& spec : table) {
    Row row = row_of(spec);
    row[0] = '`' + row[0] + '`';
    for (std::size_t c = 1; c < kColumns; ++c) row[c] = markdown_text(row[c]);
    page += '|';
    for (const std::string& cell : row) page += cell.empty() ? " |" : ' ' + cell + " |";
    page += ' ' + markdown_text(spec.text) + " |\n";
  }
  return page;
}

}  // namespace simvis
