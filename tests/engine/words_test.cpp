#include "engine/base/words.h"

#include <doctest/doctest.h>

#include <cstdint>

TEST_SUITE_BEGIN("engine");

using namespace simvis;

using Words = std::vector<std::string_view>;

TEST_CASE("words and cells are cut out of a text") {
  CHECK(words_of("").empty());
  CHECK(words_of(" \t\r\n").empty());
  CHECK(words_of(" one\ttwo \n") == Words{"one", "two"});
  CHECK(words_of(",a,, b", " ,") == Words{"a", "b"});
  CHECK(cells_of("") == Words{""});
  CHECK(cells_of(" a , ,b") == Words{"a", "", "b"});
  CHECK(cells_of("1/2/", '/') == Words{"1", "2", ""});
  CHECK(trimmed("  a b\r\n") == "a b");
  const std::string_view text = "a,  ";
  CHECK(cells_of(text)[1].data() == text.data() + text.size());  // an empty cell has a place in the text
}

TEST_CASE("lines end in LF, CR LF or CR, and rows are no comments") {
  const std::string_view text = "one\r\n\r# two\n \n three # 3\rfour";
  Words lines, rows;
  for (std::size_t at = 0; at < text.size();) lines.push_back(next_line(text, at));
  std::size_t at = 0;
  for (std::string_view row = next_row(text, at); !row.empty(); row = next_row(text, at)) rows.push_back(row);
  CHECK(lines == Words{"one", "", "# two", " ", " three # 3", "four"});
  CHECK(rows == Words{"one", " three # 3", "four"});
}

TEST_CASE("a number is a whole word") {
  CHECK(as_number<double>("-2.5e3") == -2500);
  CHECK(as_number<std::uint8_t>("255") == std::uint8_t{255});
  CHECK(as_number<std::uint32_t>("ff", 16) == 255u);
  for (const std::string_view word : {"", " 1", "1 ", "1,5", "+1", "one"}) CHECK_FALSE(as_number<double>(word));
  for (const std::string_view word : {"256", "-1", "1.0"}) CHECK_FALSE(as_number<std::uint8_t>(word));
}
