#include "scenegraph/language/attribute_rows.h"

#include <charconv>
#include <cmath>
#include <deque>
#include <mutex>

#include "engine/base/assert.h"

namespace simvis {
namespace {

// As people write it: 77e9, 2e-5.
std::string short_number(double value) {
  if (std::abs(value) >= 1e7 && std::fmod(value, 1e6) == 0) {
    int exponent = 6;
    while (std::fmod(value, std::pow(10, exponent + 3)) == 0) exponent += 3;
    return format_number(value / std::pow(10, exponent)) + "e" + std::to_string(exponent);
  }
  std::string text = format_number(value);
  const std::size_t zero = text.find("e-0");
  if (zero != text.npos) text.erase(zero + 2, 1);
  return text;
}

}  // namespace

std::string_view keep_text(std::string text) {
  static std::mutex mutex;
  static std::deque<std::string> kept;
  const std::lock_guard lock(mutex);
  return kept.emplace_back(std::move(text));
}

AttributeTable join_tables(const std::vector<std::vector<AttributeSpec>>& tables) {
  static std::mutex mutex;
  static std::deque<std::vector<AttributeSpec>> kept;
  const std::lock_guard lock(mutex);
  std::vector<AttributeSpec>& joined = kept.emplace_back();
  for (const std::vector<AttributeSpec>& table : tables) joined.insert(joined.end(), table.begin(), table.end());
  return joined;
}

std::string written_number(double value, double (*convert)(double number, double factor), double factor) {
  for (int digits = 1; digits <= 17; ++digits) {
    char text[40];
    const char* const end =
        std::to_chars(text, text + sizeof(text), value / factor, std::chars_format::general, digits).ptr;
    double number = 0;
    if (parse_number({text, end}, number) && convert(number, factor) == value) return short_number(number);
  }
  SIMVIS_ASSERT(!"no number in the unit of a row gives the default of its member");
  return {};
}

void refuse_row(const CommandAttribute& written, std::string_view when) {
  fail_at(written.where, "attribute " + in_quotes(written.name) + " is allowed only " + std::string(when));
}

}  // namespace simvis
