// The tables of options, settings and formats, from which parsing, --help, Python's signatures and documents follow.
#include "program/options/option_table.h"

#include <doctest/doctest.h>

#include <regex>
#include <set>

#include "engine/base/words.h"
#include "program/options/command_line.h"
#include "program/options/settings.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

using Words = std::vector<std::string>;

std::set<std::string> option_names() {
  std::set<std::string> names;
  for (const OptionSpec& option : option_table()) {
    for (const std::string_view name : words_of(option.names, ",")) names.emplace(name);
  }
  return names;
}

Options parsed(const Words& arguments) { return parse_options(arguments).options; }

/// A value that the option takes.
std::string allowed_value(const OptionSpec& option) {
  if (option.check == OptionCheck::one_of) return std::string(words_of(option.value, "|").back());
  return "7";
}

/// Whether the two targets hold the same value.
bool is_same(const OptionTarget& one, const OptionTarget& other) {
  return std::visit([&]<typename Value>(const Value* value) { return *value == *std::get<Value*>(other); }, one);
}

}  // namespace

TEST_CASE("the table of options names only options that are in it, each once") {
  const std::set<std::string> names = option_names();
  std::size_t count = 0;
  for (const OptionSpec& option : option_table()) {
    CAPTURE(option.names);
    count += words_of(option.names, ",").size();
    CHECK_FALSE(help_text(option).empty());
    for (const std::string_view needed : words_of(option.needs, " ")) {
      CHECK_MESSAGE(option_names().contains(std::string(needed)), needed);
    }
  }
  CHECK(names.size() == count);
  CHECK(count > 50);
  for (const OptionExclusion& exclusion : option_exclusions()) {
    CHECK(names.contains(std::string(exclusion.option)));
    for (const std::string_view other : words_of(exclusion.others, " ")) {
      CHECK_MESSAGE(names.contains(std::string(other)), other);
    }
  }
}

TEST_CASE("each option of the table sets its own value and no other") {
  const std::set<std::string> wishes = {"--version", "--help"};
  for (const OptionSpec& option : option_table()) {
    const std::string name(words_of(option.names, ",").back());
    if (wishes.contains(name)) continue;
    CAPTURE(name);
    Words arguments = {"scene.xml"};
    for (const OptionSpec& needed : option_table()) {
      if (option.needs.empty() || needed.names != words_of(option.needs, " ").front()) continue;
      arguments.push_back(std::string(needed.names));
      if (!needed.value.empty()) arguments.push_back(allowed_value(needed));
      if (needed.needs.empty()) continue;
      arguments.insert(arguments.end(), {std::string(needed.needs), "7"});  // --lockstep needs --serve
    }
    Options without = parsed(arguments);
    arguments.push_back(name);
    if (!option.value.empty()) arguments.push_back(allowed_value(option));
    Options with = parsed(arguments);
    for (const OptionSpec& other : option_table()) {
      const std::optional<OptionTarget> one = target_of(other, without), two = target_of(other, with);
      if (!one) continue;
      CAPTURE(other.names);
      CHECK(is_same(*one, *two) == (other.names != option.names));
    }
  }
}

TEST_CASE("an option without the one that it belongs to is refused") {
  for (const OptionSpec& option : option_table()) {
    if (option.needs.empty()) continue;
    CAPTURE(option.names);
    Words arguments = {"scene.xml", std::string(option.names)};
    if (!option.value.empty()) arguments.push_back(allowed_value(option));
    const std::string error = error_of([&] { parse_options(arguments); });
    CHECK(
        error.starts_with(std::string(option.names) + " requires " + std::string(words_of(option.needs, " ").front())));
  }
}

TEST_CASE("values that an option does not take are refused") {
  for (const OptionSpec& option : option_table()) {
    const bool takes_text = option.check == OptionCheck::none;
    if (takes_text) continue;
    CAPTURE(option.names);
    const std::string name(option.names);
    CHECK_FALSE(error_of([&] { parse_options({"scene.xml", name, ""}); }).empty());
    if (option.check == OptionCheck::above_zero) {
      CHECK_FALSE(error_of([&] { parse_options({"scene.xml", name, "0"}); }).empty());
    }
    if (option.check == OptionCheck::whole) {
      CHECK_FALSE(error_of([&] { parse_options({"scene.xml", name, "-1"}); }).empty());
      CHECK_FALSE(error_of([&] { parse_options({"scene.xml", name, "1.5"}); }).empty());
    }
    if (option.check == OptionCheck::one_of) {
      CHECK_FALSE(error_of([&] { parse_options({"scene.xml", name, "other"}); }).empty());
    }
  }
}

TEST_CASE("every field of SimulationDesc is a setting, or is none of the users'") {
  const std::string header = read_text(std::filesystem::path(SIMVIS_SOURCE_DIR) / "include/simvis/simulation_desc.h");
  const std::size_t start = header.find("struct SimulationDesc {");
  REQUIRE(start != header.npos);
  const std::string body = header.substr(start, header.find("\n};", start) - start);
  // elements_move is set by followers; a whole device is several settings; frames_when_due is that rate_hz is absent.
  std::set<std::string> names = {"elements_move", "device", "frames_when_due"};
  for (const SettingSpec& setting : simulation_settings()) names.insert(std::string(setting.name));
  const std::regex field(R"(\n  [A-Za-z][\w:<>]* (\w+)( = [^;]*|\{\})?;)");
  int fields = 0;
  for (auto at = std::sregex_iterator(body.begin(), body.end(), field); at != std::sregex_iterator(); ++at) {
    ++fields;
    CHECK_MESSAGE(names.contains((*at)[1]), (*at)[1].str(), " has no row in program/options/settings.cpp");
  }
  CHECK(fields == 11);
}

TEST_CASE("each setting has a place of its own") {
  SimulationDesc desc;
  std::set<const void*> places;
  for (const SettingSpec& setting : simulation_settings()) {
    CAPTURE(setting.name);
    CHECK_FALSE(setting.text.empty());
    CHECK(setting.absent.empty() == (setting.is_absent == nullptr));
    CHECK(places.insert(std::visit([](auto* field) -> const void* { return field; }, setting.field(desc))).second);
    CHECK(&simulation_setting(setting.name) == &setting);
  }
}

}  // namespace simvis

TEST_SUITE_END();
