// Attribute tables: defaults, ranges, choices, and messages about wrong values.
#include <simvis/attributes.h>

#include <doctest/doctest.h>

#include <cmath>

#include "scenegraph/language/markdown.h"
#include "tests/support/error_of.h"

TEST_SUITE_BEGIN("scenegraph");

namespace simvis {
namespace {

constexpr AttributeSpec kTable[] = {
    {.name = "hfov",
     .kind = AttributeKind::number,
     .default_value = "60",
     .unit = "deg",
     .text = "horizontal field of view",
     .min = 0,
     .max = 180,
     .open_min = true,
     .open_max = true},
    {.name = "width", .kind = AttributeKind::integer, .default_value = "640", .text = "pixels", .min = 1, .max = 16384},
    {.name = "outputs",
     .kind = AttributeKind::flags,
     .default_value = "color",
     .text = "what to take",
     .choices = "color depth"},
    {.name = "method", .kind = AttributeKind::choice, .text = "how", .choices = "nearest planar"},
    {.name = "axis", .kind = AttributeKind::vector, .default_value = "0 0 1", .text = "which way"},
    {.name = "speed",
     .kind = AttributeKind::number,
     .default_value = "1",
     .unit = "m/s",
     .text = "how fast",
     .live = true},
    {.name = "rate", .kind = AttributeKind::number, .unit = "Hz", .text = "how often", .min = 0, .open_min = true},
};
constexpr std::string_view kCommon[] = {"type", "name"};

AttributeValues values(const std::string& attributes) {
  const std::vector<Command> commands = parse_commands("<sensor type='t' " + attributes + "/>", "s.xml", "");
  return AttributeValues(commands.at(0), kTable, kCommon);
}
std::string error(const std::string& attributes) {
  return error_of([&] { values(attributes); });
}

TEST_CASE("missing attributes have their defaults") {
  const AttributeValues v = values("");
  CHECK(v.number("hfov") == 60);
  CHECK(v.integer("width") == 640);
  CHECK(v.flag("outputs", "color"));
  CHECK_FALSE(v.flag("outputs", "depth"));
  CHECK_FALSE(v.is_set("method"));
  CHECK_FALSE(v.is_set("rate"));
  CHECK(v.vector("axis")[2] == 1);
  CHECK(to_string(v.where("hfov")) == "s.xml:1:2");
}

TEST_CASE("written attributes are read") {
  const AttributeValues v = values("hfov=' 1.5e1 ' width='1' outputs='depth  color' method='planar' axis='-1 .5 2.'");
  CHECK(v.number("hfov") == 15);
  CHECK(v.integer("width") == 1);
  CHECK(v.flag("outputs", "depth"));
  CHECK(v.flag("outputs", "color"));
  CHECK(v.choice("method") == "planar");
  CHECK(v.vector("axis")[0] == -1);
  CHECK(v.vector("axis")[1] == 0.5);
  CHECK(v.vector("axis")[2] == 2);
  CHECK(to_string(v.where("hfov")) == "s.xml:1:18");
}

TEST_CASE("wrong values are refused at the attribute") {
  CHECK(error("hfov='180'") ==
        "s.xml:1:18: error: attribute \"hfov\": 180 is not allowed, expected a number greater than 0 and below 180 "
        "(deg)");
  CHECK(error("rate='0'") ==
        "s.xml:1:18: error: attribute \"rate\": 0 is not allowed, expected a number greater than 0 (Hz)");
  CHECK(error("width='0'") ==
        "s.xml:1:18: error: attribute \"width\": 0 is not allowed, expected a whole number from 1 to 16384");
  CHECK(contains(error("width='2.5'"), "\"2.5\" is not allowed, expected a whole number"));
  CHECK(contains(error("width='99999999999999999999'"), "expected a whole number from 1 to 16384"));
  CHECK(
      error("method='plannar'") ==
      "s.xml:1:18: error: attribute \"method\": \"plannar\" is not allowed, expected one of: nearest, planar, did you "
      "mean \"planar\"?");
  CHECK(contains(error("method='nearest planar'"), "expected one of: nearest, planar"));
  CHECK(contains(error("outputs=''"), "expected one or more of, each once: color, depth"));
  CHECK(contains(error("outputs='color color'"), "each once"));
  CHECK(contains(error("axis='1 2'"), "expected three finite numbers"));
  CHECK(contains(error("axis='1 2 nan'"), "expected three finite numbers"));
  CHECK(error("hfvo='60'") == "s.xml:1:18: error: unknown attribute \"hfvo\", did you mean \"hfov\"?");
  CHECK(contains(error("zzz='60'"), "s.xml:1:18: error: unknown attribute \"zzz\", expected one of: "));
}

TEST_CASE("only finite decimal numbers are numbers") {
  for (const char* text : {"nan", "inf", "-inf", "+1", "0x10", "1e999", "1 2", "", " ", "1,5", "1m", "--1", "1e"}) {
    CAPTURE(text);
    double value = 0;
    CHECK_FALSE(parse_number(text, value));
    CHECK(contains(error("speed='" + std::string(text) + "'"), "expected a finite number (m/s)"));
  }
  double value = 0;
  CHECK(parse_number("\t-2.5e-3\n", value));
  CHECK(value == -2.5e-3);
  CHECK(check_number(kTable[5], std::nan("")) == "nan is not allowed, expected a finite number");
  CHECK(check_number(kTable[0], 179.999).empty());
}

TEST_CASE("numbers are printed so that they read back") {
  CHECK(format_number(1000000) == "1000000");
  CHECK(format_number(0.1) == "0.1");
  CHECK(format_number(-2.5e-300) == "-2.5e-300");
  CHECK(format_number(1e15) == "1e+15");
}

TEST_CASE("the nearest name is a likely typing error") {
  constexpr std::string_view kNames[] = {"x", "y", "hfov", "R_POSE", "laser_scanner", "resolution"};
  CHECK(nearest_name("lasersanner", kNames) == "laser_scanner");
  CHECK(nearest_name("fov", kNames) == "hfov");
  CHECK(nearest_name("r_pose", kNames) == "R_POSE");
  CHECK(nearest_name("X", kNames) == "x");
  CHECK(nearest_name("resolution_px", kNames) == "resolution");
  CHECK(nearest_name("z", kNames).empty());
  CHECK(nearest_name("", kNames).empty());
  CHECK(nearest_name("camera", kNames).empty());
  CHECK(nearest_name(std::string(1000000, 'a'), kNames).empty());
}

TEST_CASE("the description shows every row within 100 columns") {
  const std::string page = describe("camera", "takes pictures", kTable);
  for (const AttributeSpec& spec : kTable) CHECK(contains(page, "\n" + std::string(spec.name) + " "));
  CHECK(contains(page, "camera: takes pictures\n"));
  CHECK(contains(page, "> 0, < 180"));
  CHECK(contains(page, "one of nearest, planar"));
  CHECK(contains(page, ", live\n"));
  CHECK(contains(page, " how fast"));
  std::string long_text;
  for (int i = 0; i < 60; ++i) long_text += "word ";
  AttributeSpec wordy = kTable[0];
  wordy.text = long_text;
  const std::string wrapped = describe("t", "s", {&wordy, 1});
  std::size_t begin = 0;
  std::size_t words = 0;
  for (std::size_t at = wrapped.find("word"); at != std::string::npos; at = wrapped.find("word", at + 1)) ++words;
  CHECK(words == 60);
  while (begin < wrapped.size()) {
    const std::size_t end = wrapped.find('\n', begin);
    CHECK(end - begin <= 100);
    begin = end + 1;
  }
}

TEST_CASE("notes are paragraphs between the summary and the table") {
  CHECK(contains(describe("t", "s", kTable, "one\ntwo"), "t: s\n\none\n\ntwo\n\n" + std::string(kTable[0].name) + " "));
  CHECK(describe("t", "s", {}, "one") == "t: s\n\none\n");
}

TEST_CASE("a Markdown table has a line for each attribute and escapes the texts") {
  const AttributeSpec row{
      .name = "kind", .kind = AttributeKind::choice, .default_value = "a", .text = "a * b [c]", .choices = "a b"};
  CHECK(markdown_table({&row, 1}) ==
        "| name | kind | default | unit | allowed | live | meaning |\n"
        "|---|---|---|---|---|---|---|\n"
        "| `kind` | choice | a | | a\\|b | | a \\* b \\[c] |\n");
  CHECK(markdown_table({}) == "");
}

TEST_CASE("a mistake in a table is detected") {
  CHECK(check_table(kTable).empty());
  AttributeSpec rows[] = {kTable[0], kTable[0]};
  CHECK(check_table(rows) == "attribute \"hfov\": is in the table twice");
  rows[0].default_value = "200";
  CHECK(contains(check_table({rows, 1}), "default 200 is not allowed"));
  rows[0].default_value = "";
  rows[0].live = true;
  CHECK(contains(check_table({rows, 1}), "a live row must be a number with a default"));
  AttributeSpec turn{.name = "turn", .default_value = "0", .unit = "deg", .live = true, .full_turn = true};
  CHECK(check_table({&turn, 1}).empty());
  turn.min = -180;
  CHECK(contains(check_table({&turn, 1}), "an angle of full turns must be in degrees and without limits"));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
