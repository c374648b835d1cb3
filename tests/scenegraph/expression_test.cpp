// Arithmetic in scene files.
#include "scenegraph/language/expression.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "tests/support/error_of.h"
#include "tests/support/random_numbers.h"

TEST_SUITE_BEGIN("scenegraph");

namespace simvis {
namespace {

const VariableValues kVariables{{"i", 3}, {"width", 4.5}};

double value_of(std::string_view text) {
  double value = NAN;
  const std::string wrong = evaluate(text, kVariables, value);
  CAPTURE(text);
  CHECK(wrong == "");
  return value;
}

std::string wrong_with(std::string_view text) {
  double value = NAN;
  return evaluate(text, kVariables, value);
}

TEST_CASE("expressions have the values of arithmetic") {
  CHECK(value_of("1 + 2 * 3") == 7);
  CHECK(value_of("(1+2)*3") == 9);
  CHECK(value_of("10 - 4 - 3") == 3);
  CHECK(value_of("16 / 4 / 2") == 2);
  CHECK(value_of("-2 * -3") == 6);
  CHECK(value_of("2 - -3") == 5);
  CHECK(value_of(" width / 2 ") == 2.25);
  CHECK(value_of("i * 0.5") == 1.5);
  CHECK(value_of("1e-3 + .5") == 0.501);
  CHECK(value_of("pi") == std::numbers::pi);
  CHECK(value_of("sqrt(9) + abs(-2) + floor(2.7) + round(1.6)") == 9);
  CHECK(value_of("min(3, 2) + max(3, 2) * 10") == 32);
  CHECK(value_of("mod(7, 3) + mod(-1, 3) * 10") == 21);
  CHECK_FALSE(std::signbit(value_of("-0")));
}

TEST_CASE("angles are degrees, and quarter turns are exact") {
  CHECK(value_of("sin(90)") == 1);
  CHECK(value_of("cos(90)") == 0);
  CHECK(value_of("cos(180)") == -1);
  CHECK(value_of("sin(30)") == doctest::Approx(0.5).epsilon(1e-15));
  CHECK(value_of("tan(45)") == doctest::Approx(1).epsilon(1e-15));
  CHECK(value_of("atan2(1, 1)") == doctest::Approx(45).epsilon(1e-15));
  CHECK(value_of("asin(1) + acos(1) + atan(1)") == doctest::Approx(135).epsilon(1e-15));
}

TEST_CASE("what is no expression, or has no finite value, is said") {
  CHECK(wrong_with("") == "it ends where a value is expected");
  CHECK(wrong_with("1 +") == "it ends where a value is expected");
  CHECK(wrong_with("1 2") == "unexpected \"2\"");
  CHECK(wrong_with("1 $ 2") == "unexpected \"$ 2\"");
  CHECK(wrong_with("(1 + 2") == "\"(\" without \")\"");
  CHECK(wrong_with("1)") == "unexpected \")\"");
  CHECK(wrong_with("widht") == "there is no variable \"widht\", did you mean \"width\"?");
  CHECK(contains(wrong_with("sine(1)"), "there is no function \"sine\""));
  CHECK(contains(wrong_with("min(1)"), "min takes 2 values"));
  CHECK(contains(wrong_with("sin(1, 2)"), "sin takes 1 value"));
  CHECK(wrong_with("1 / 0") == "division by zero");
  CHECK(wrong_with("1 / (i - 3)") == "division by zero");
  CHECK(contains(wrong_with("sqrt(-1)"), "sqrt is not finite"));
  CHECK(contains(wrong_with("mod(1, 0)"), "mod is not finite"));
  CHECK(contains(wrong_with("tan(90)"), "tan is not finite"));
  CHECK(contains(wrong_with("1e308 * 10"), "* is not finite"));
  CHECK(wrong_with("1e999") == "a number is out of range");
  CHECK(contains(wrong_with("inf"), "there is no variable \"inf\""));
  CHECK(contains(wrong_with(std::string(100000, '(')), "nested deeper than 64"));
  CHECK(contains(wrong_with(std::string(100000, '-')), "nested deeper than 64"));
}

TEST_CASE("expressions in texts are replaced by the shortest text of their values") {
  const auto replaced = [](std::string text) {
    CHECK(substitute(text, kVariables) == "");
    return text;
  };
  CHECK(replaced("a $ b { c } d") == "a $ b { c } d");
  CHECK(replaced("TABLE_${i}") == "TABLE_3");
  CHECK(replaced("${i} ${ -width } ${1000000}${0.1 + 0.2}") == "3 -4.5 10000000.30000000000000004");
  std::string text = "x${1 + ";
  CHECK(contains(substitute(text, kVariables), "\"${\" without \"}\""));
  text = "${1 / 0}";
  CHECK(substitute(text, kVariables) == "\"${1 / 0}\": division by zero");
}

TEST_CASE("names of variables") {
  for (const char* name : {"x", "_", "wall_2", "PI", "Sin"}) CHECK(is_variable_name(name));
  for (const char* name : {"", "2x", "a b", "a.b", "a-b", "pi", "sin", "\xc3\xa4"}) CHECK_FALSE(is_variable_name(name));
}

TEST_CASE("random texts give a finite value or a message") {
  constexpr std::string_view kPieces[] = {"1",  "0",   "2.5", "1e300", "i",    "pi", "width", "sin(", "min(",  "sqrt(",
                                          "(",  ")",   "+",   "-",     "*",    "/",  ",",     " ",    "${",    "}",
                                          "e9", "nan", ".",   "mod(",  "tan(", "x",  "\t",    "\xc3", "atan2("};
  constexpr int kTexts = 200000;
  test::Random random(7);
  int values = 0, messages = 0;
  for (int n = 0; n < kTexts; ++n) {
    std::string text;
    for (std::uint64_t pieces = random.below(12); pieces > 0; --pieces)
      text += kPieces[random.below(std::size(kPieces))];
    double value = NAN;
    const std::string wrong = evaluate(text, kVariables, value);
    ++(wrong.empty() ? values : messages);
    if (wrong.empty() != std::isfinite(value) && wrong.empty()) FAIL_CHECK(text);
    substitute(text, kVariables);
  }
  CHECK(values > kTexts / 100);
  CHECK(messages > kTexts / 2);
}

}  // namespace
}  // namespace simvis
