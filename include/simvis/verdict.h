// What a matcher of <simvis/testing.h> says of a measurement, in words that a failing test prints.
#pragma once

#include <charconv>
#include <cstddef>
#include <ostream>
#include <string>

/// A namespace simvis::testing would make the names of GoogleTest's namespace `testing` ambiguous in tests with
/// `using namespace simvis`.
namespace simvis::test_kit {

namespace detail {

/// Nine digits, which tell any two floats apart.
inline std::string number(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value, std::chars_format::general, 9).ptr};
}

/// Three digits, of a bound or a difference.
inline std::string short_number(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value, std::chars_format::general, 3).ptr};
}

}  // namespace detail

/// The beam of a scan that a verdict is about.
struct JudgedBeam {
  /// `range_m.data()` of the scan, which finds its sensor again and is not read. Null: the verdict is about no beam.
  const float* ranges = nullptr;
  std::size_t index = 0;  ///< ring * beams + beam
};

/// The result of a matcher. Each framework prints its text where it is false: doctest and Catch2 in CHECK(verdict),
/// GoogleTest in EXPECT_TRUE(verdict).
struct Verdict {
  bool ok = false;    ///< what the matcher says
  std::string text;   ///< what was measured, what was expected, and by how much they differ
  JudgedBeam beam{};  ///< of a scan: the one that `text` names; the page of a failing run selects it

  explicit operator bool() const { return ok; }  ///< `ok`
  /// The AssertionResult of GoogleTest, without a dependency on it.
  template <typename Result>
  requires requires(Result result) { result.failure_message(); }
  operator Result() const {  // NOLINT(google-explicit-constructor): EXPECT_TRUE converts by assignment
    return Result(ok) << text;
  }
  /// Writes the text.
  friend std::ostream& operator<<(std::ostream& out, const Verdict& verdict) { return out << verdict.text; }
};

}  // namespace simvis::test_kit
