// README.md speaks of what is there: its example is the one that is compiled, its tables have every type's attributes.
#include <doctest/doctest.h>

#include <algorithm>
#include <string>

#include <simvis/effect.h>
#include <simvis/element.h>
#include <simvis/sensor.h>
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

constexpr std::ptrdiff_t kMaxLines = 40;  // of the example that shows how to write an element

const std::string kReadme = read_text(SIMVIS_SOURCE_DIR "/README.md");

// From the line that says "**NAME**" to the next that begins so, or to the next heading.
std::string section(std::string_view type) {
  const std::size_t start = kReadme.find("\n**" + std::string(type) + "** ");
  if (start == std::string::npos) return "";
  const std::size_t end = std::min(kReadme.find("\n**", start + 1), kReadme.find("\n#", start + 1));
  return kReadme.substr(start, end - start);
}

template <typename Type>
void check_documented(const Type& type, AttributeTable attributes) {
  CAPTURE(type.name);
  const std::string text = section(type.name);
  REQUIRE_FALSE(text.empty());
  for (const AttributeSpec& attribute : attributes) {
    CAPTURE(attribute.name);
    CHECK(text.find("`" + std::string(attribute.name) + "`") != std::string::npos);
  }
}

}  // namespace

TEST_CASE("the element in the README is the one that is compiled and run, and short") {
  const std::string code = read_text(SIMVIS_SOURCE_DIR "/tests/plugin/door.cpp");
  REQUIRE_FALSE(code.empty());
  CHECK(std::ranges::count(code, '\n') < kMaxLines);
  CHECK(kReadme.find("```cpp\n" + code + "```") != std::string::npos);
}

TEST_CASE("every element and sensor type stands in the README with its attributes") {
  for (const ElementType* type : element_types()) check_documented(*type, type->attributes);
  for (const SensorType* type : sensor_types()) check_documented(*type, type->attributes);
}

TEST_CASE("every effect stands in the README with its attributes") {
  for (const EffectType* type : effect_types()) check_documented(*type, type->attributes);
}

}  // namespace simvis

TEST_SUITE_END();
