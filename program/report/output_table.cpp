#include "program/report/output_table.h"

#include <algorithm>
#include <array>
#include <vector>

#include <simvis/attributes.h>
#include "scenegraph/language/markdown.h"
#include "scenegraph/language/text_table.h"

namespace simvis {
namespace {

TextRow heads() { return {"name", "kind", "number", "shape", "unit", "frame", "nothing", "meaning"}; }

// The meaning, then what belongs to it in words: the bound, the message, the condition.
std::string sentence(const OutputSpec& output) {
  std::string text = output.meaning;
  const auto add = [&text](std::string_view label, const std::string& fact) {
    if (!fact.empty()) text += (text.empty() ? "" : "; ") + std::string(label) + fact;
  };
  add("error: at most ", output.bound);
  add("given with: ", output.when);
  add("message: ", output.message);
  if (output.on_request) add("", "computed when it is read; of files only run.json has it, of messages none");
  return text;
}

TextRow row_of(const OutputSpec& output) {
  return {output.name,
          std::string(to_string(output.kind)),
          std::string(to_string(output.value_type)),
          to_string(output.shape),
          output.unit,
          output.frame,
          output.nothing ? format_number(*output.nothing) : "",
          sentence(output)};
}

// The form of the output: "image of f32, 480 x 640 (m), frame optical, nothing: inf".
std::string facts_of(const OutputSpec& output) {
  std::string facts = std::string(to_string(output.kind)) + " of " + std::string(to_string(output.value_type));
  if (output.shape != OutputShape{}) facts += ", " + to_string(output.shape);
  if (!output.unit.empty()) facts += " (" + output.unit + ")";
  if (!output.frame.empty()) facts += ", frame " + output.frame;
  if (output.nothing) facts += ", nothing: " + format_number(*output.nothing);
  return facts;
}

}  // namespace

std::string output_text_table(std::span<const OutputSpec> outputs) {
  if (outputs.empty()) return "";
  std::vector<TextRow> rows;
  for (const OutputSpec& output : outputs) {
    rows.push_back({output.name, facts_of(output)});
    rows.push_back({"", sentence(output)});
  }
  return "\ngives:\n" + text_table(rows);
}

std::string output_markdown_table(std::span<const OutputSpec> outputs) {
  if (outputs.empty()) return "";
  std::vector<TextRow> rows;
  for (const OutputSpec& output : outputs) {
    TextRow row = row_of(output);
    for (std::size_t cell = 1; cell < row.size(); ++cell) row[cell] = markdown_text(row[cell]);
    row[0] = '`' + row[0] + '`';
    rows.push_back(std::move(row));
  }
  return "It gives:\n\n" + markdown_rows(heads(), rows);
}

nlohmann::ordered_json output_json(const OutputSpec& output) {
  const OutputShape& shape = output.shape;
  return {{"name", output.name},
          {"kind", std::string(to_string(output.kind))},
          {"number", std::string(to_string(output.value_type))},
          {"shape", {shape.rows, shape.columns, shape.channels}},
          {"unit", output.unit},
          {"frame", output.frame},
          {"meaning", output.meaning},
          {"nothing", output.nothing ? nlohmann::ordered_json(format_number(*output.nothing)) : nullptr},
          {"bound", output.bound},
          {"message", output.message},
          {"derived", output.derived},
          {"on_request", output.on_request}};
}

}  // namespace simvis
