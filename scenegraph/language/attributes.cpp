#include <simvis/attributes.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "engine/base/assert.h"
#include "engine/base/words.h"

namespace simvis {
namespace {

bool parse_integer(std::string_view text, std::int64_t& value) {
  const std::optional<std::int64_t> number = as_number<std::int64_t>(trimmed(text));
  if (number) value = *number;
  return number.has_value();
}

// "color depth" -> "color, depth"
std::string listed(std::string_view choices) {
  std::string text;
  for (const std::string_view word : words_of(choices)) text += (text.empty() ? "" : ", ") + std::string(word);
  return text;
}

// "from 0 to 10", "greater than 0 and below 180"; empty without limits.
std::string range_text(const AttributeSpec& spec) {
  const bool has_min = spec.min != -kNoLimit, has_max = spec.max != kNoLimit;
  if (has_min && has_max && !spec.open_min && !spec.open_max) {
    return "from " + format_number(spec.min) + " to " + format_number(spec.max);
  }
  std::string text;
  if (has_min) text += (spec.open_min ? "greater than " : "at least ") + format_number(spec.min);
  if (has_min && has_max) text += " and ";
  if (has_max) text += (spec.open_max ? "below " : "at most ") + format_number(spec.max);
  return text;
}

// The values that a row allows: "a number greater than 0 and below 180 (deg)".
std::string expected(const AttributeSpec& spec) {
  switch (spec.kind) {
    case AttributeKind::choice:
      return "one of: " + listed(spec.choices);
    case AttributeKind::flags:
      return "one or more of, each once: " + listed(spec.choices);
    case AttributeKind::vector:
      return range_text(spec).empty() ? "three finite numbers" : "three numbers " + range_text(spec);
    case AttributeKind::text:
      return "a text that is not empty";
    case AttributeKind::file:
      return "the name of a file";
    case AttributeKind::part:
      return "the name of a part";
    case AttributeKind::object:
      return "the name of a part or link";
    case AttributeKind::objects:
      return "names or patterns of parts and links, separated by spaces";
    case AttributeKind::element:
      return "the name of an element";
    case AttributeKind::sensor:
      return "the name of a sensor";
    case AttributeKind::number:
    case AttributeKind::integer:
      break;
  }
  const std::string range = range_text(spec);
  std::string text = spec.kind == AttributeKind::integer ? "a whole number"
                     : range.empty()                     ? "a finite number"
                                                         : "a number";
  if (!range.empty()) text += " " + range;
  if (!spec.unit.empty()) text += " (" + std::string(spec.unit) + ")";
  return text;
}

std::string refusal(std::string_view seen, std::string_view expectation) {
  return std::string(seen) + " is not allowed, expected " + std::string(expectation);
}

// What could be meant by an unknown name: the nearest known name, else all of them.
std::string meant_or_all(std::string_view seen, std::span<const std::string_view> known) {
  const std::string nearest = suggestion(seen, known);
  if (!nearest.empty() || known.empty()) return nearest;
  std::string text;
  for (const std::string_view name : known) text += (text.empty() ? ", expected one of: " : ", ") + std::string(name);
  return text;
}

bool in_range(const AttributeSpec& spec, double value) {
  const bool above = spec.open_min ? value > spec.min : value >= spec.min - spec.rounding;
  const bool below = spec.open_max ? value < spec.max : value <= spec.max + spec.rounding;
  // The value is finite, so infinite limits have no effect, open or not.
  return above && below;
}

// Reads the words of a choice or of flags. Returns false if a word is unknown or written twice.
bool read_words(std::string_view text, const AttributeSpec& spec, std::vector<std::string>& words) {
  const std::vector<std::string_view> allowed = words_of(spec.choices);
  for (const std::string_view word : words_of(text)) {
    if (std::ranges::find(allowed, word) == allowed.end()) return false;
    if (std::ranges::find(words, word) != words.end()) return false;
    words.emplace_back(word);
  }
  return spec.kind == AttributeKind::choice ? words.size() == 1 : !words.empty();
}

// What is wrong with words that read_words() refuses.
std::string refusal_of_words(std::string_view text, const AttributeSpec& spec) {
  const std::vector<std::string_view> allowed = words_of(spec.choices), words = words_of(text);
  std::string message = refusal(in_quotes(text), expected(spec));
  if (spec.kind == AttributeKind::flags && text.find(',') != text.npos) return message + "; separated by spaces";
  const auto unknown =
      std::ranges::find_if(words, [&](std::string_view word) { return std::ranges::count(allowed, word) == 0; });
  if (unknown == words.end() || words.size() == 1) return message + suggestion(text, allowed);
  return message + "; " + in_quotes(*unknown) + " is none of them" + suggestion(*unknown, allowed);
}

}  // namespace

bool parse_numbers(std::string_view text, std::span<double> values) {
  const std::vector<std::string_view> words = words_of(text);
  if (words.size() != values.size()) return false;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::optional<double> number = as_number<double>(words[i]);
    if (!number || !std::isfinite(*number)) return false;
    values[i] = *number;
  }
  return true;
}

bool parse_number(std::string_view text, double& value) { return parse_numbers(text, {&value, 1}); }

std::string format_number(double value) {
  char text[40];
  // Whole numbers below 1e9 are written without an exponent: 1000000, not 1e+06.
  const bool whole = std::abs(value) < 1e9 && value == std::floor(value);
  char* end = text + sizeof(text);
  end = whole ? std::to_chars(text, end, value, std::chars_format::fixed).ptr : std::to_chars(text, end, value).ptr;
  return {text, end};
}

bool names_file(const AttributeSpec& spec, std::string_view value) {
  if (spec.kind != AttributeKind::file) return false;
  return std::ranges::none_of(words_of(spec.choices), [&](std::string_view start) { return value.starts_with(start); });
}

std::string check_number(const AttributeSpec& spec, double value) {
  if (!std::isfinite(value)) return refusal(format_number(value), "a finite number");
  const bool whole = spec.kind != AttributeKind::integer || value == std::floor(value);
  return whole && in_range(spec, value) ? "" : refusal(format_number(value), expected(spec));
}

// Sets the value from the text. Returns the error in the text, or an empty string.
std::string AttributeValues::read(std::string_view text, Value& value) {
  const AttributeSpec& spec = value.spec;
  value.set = true;
  switch (spec.kind) {
    case AttributeKind::number:
      if (!parse_number(text, value.number[0])) return refusal(in_quotes(text), expected(spec));
      return check_number(spec, value.number[0]);
    case AttributeKind::integer:
      if (!parse_integer(text, value.integer)) return refusal(in_quotes(text), expected(spec));
      return check_number(spec, static_cast<double>(value.integer));
    case AttributeKind::vector:
      if (!parse_numbers(text, value.number)) return refusal(in_quotes(text), expected(spec));
      for (const double number : value.number) {
        if (!in_range(spec, number)) return refusal(in_quotes(text), expected(spec));
      }
      return "";
    case AttributeKind::text:
    case AttributeKind::file:
    case AttributeKind::part:
    case AttributeKind::object:
    case AttributeKind::objects:
    case AttributeKind::element:
    case AttributeKind::sensor:
      value.words.emplace_back(text);
      return !trimmed(text).empty() ? "" : refusal(in_quotes(text), expected(spec));
    case AttributeKind::choice:
    case AttributeKind::flags:
      break;
  }
  return read_words(text, spec, value.words) ? "" : refusal_of_words(text, spec);
}

AttributeValues::AttributeValues(const Command& command, AttributeTable table,
                                 std::span<const std::string_view> common) {
  std::vector<std::string_view> known(common.begin(), common.end());
  for (const AttributeSpec& spec : table) known.push_back(spec.name);
  for (const CommandAttribute& attribute : command.attributes) {
    if (std::ranges::find(known, attribute.name) == known.end()) {
      fail_at(attribute.where, "unknown attribute " + in_quotes(attribute.name) + meant_or_all(attribute.name, known));
    }
  }
  for (const AttributeSpec& spec : table) {
    Value& value = values_.emplace_back();
    value.spec = spec;
    const CommandAttribute* attribute = command.find(spec.name);
    value.where = attribute != nullptr ? attribute->where : command.where;
    if (attribute == nullptr && spec.default_value.empty()) continue;
    const std::string wrong = read(attribute != nullptr ? attribute->value : spec.default_value, value);
    if (!wrong.empty()) fail_at(value.where, "attribute " + in_quotes(spec.name) + ": " + wrong);
  }
}

const AttributeValues::Value* AttributeValues::find(std::string_view name) const {
  const auto found = std::ranges::find(values_, name, [](const Value& value) { return value.spec.name; });
  return found == values_.end() ? nullptr : &*found;
}

const AttributeValues::Value& AttributeValues::value(std::string_view name, AttributeKind kind) const {
  const Value* value = find(name);
  SIMVIS_ASSERT(value != nullptr);
  SIMVIS_ASSERT(value->spec.kind == kind);
  SIMVIS_ASSERT(value->set);
  return *value;
}

bool AttributeValues::is_set(std::string_view name) const {
  const Value* value = find(name);
  SIMVIS_ASSERT(value != nullptr);
  return value->set;
}

double AttributeValues::number(std::string_view name) const { return value(name, AttributeKind::number).number[0]; }

std::int64_t AttributeValues::integer(std::string_view name) const {
  return value(name, AttributeKind::integer).integer;
}

const std::string& AttributeValues::choice(std::string_view name) const {
  return value(name, AttributeKind::choice).words[0];
}

bool AttributeValues::flag(std::string_view name, std::string_view choice) const {
  const Value& flags = value(name, AttributeKind::flags);
  SIMVIS_ASSERT(std::ranges::count(words_of(flags.spec.choices), choice) == 1);
  return std::ranges::find(flags.words, choice) != flags.words.end();
}

const double (&AttributeValues::vector(std::string_view name) const)[3] {
  return value(name, AttributeKind::vector).number;
}

const std::string& AttributeValues::text(std::string_view name) const {
  const Value* found = find(name);
  SIMVIS_ASSERT(found != nullptr && found->set);
  const AttributeKind kind = found->spec.kind;
  SIMVIS_ASSERT(kind == AttributeKind::text || kind == AttributeKind::file || kind == AttributeKind::objects ||
                is_reference(kind));
  return found->words[0];
}

const Location& AttributeValues::where(std::string_view name) const {
  const Value* value = find(name);
  SIMVIS_ASSERT(value != nullptr);
  return value->where;
}

std::string check_table(AttributeTable table) {
  for (std::size_t i = 0; i < table.size(); ++i) {
    const AttributeSpec& spec = table[i];
    const std::string row = "attribute " + in_quotes(spec.name) + ": ";
    if (std::ranges::count(table, spec.name, &AttributeSpec::name) > 1) return row + "is in the table twice";
    if (spec.live && (spec.kind != AttributeKind::number || spec.default_value.empty())) {
      return row + "a live row must be a number with a default";
    }
    if (spec.full_turn && (spec.unit != "deg" || spec.min != -kNoLimit || spec.max != kNoLimit)) {
      return row + "an angle of full turns must be in degrees and without limits";
    }
    AttributeValues::Value value;
    value.spec = spec;
    const std::string wrong = spec.default_value.empty() ? "" : AttributeValues::read(spec.default_value, value);
    if (!wrong.empty()) return row + "default " + wrong;
  }
  return "";
}

}  // namespace simvis
