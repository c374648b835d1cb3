// What a matcher of <simvis/testing.h> says of a measurement, in words that a failing test prints.
#pragma once

#include <ostream>
#include <string>

/// A namespace simvis::testing would make the names of GoogleTest's namespace `testing` ambiguous in tests with
/// `using namespace simvis`.
namespace simvis::test_kit {

/// The result of a matcher. Each framework prints its text where it is false: doctest and Catch2 in CHECK(verdict),
/// GoogleTest in EXPECT_TRUE(verdict).
struct Verdict {
  bool ok = false;   ///< what the matcher says
  std::string text;  ///< what was measured, what was expected, and by how much they differ

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
