// Points in text: a line of numbers each.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

#include "import/programs/clouds/point_columns.h"

namespace simvis {

/// The next line of a text from `at` on, without its end. `at` moves behind it.
std::string_view line_of(std::string_view text, std::size_t& at);

/// The numbers of `count` lines from `at` on, `columns` in each line, row by row; more words in a line are left out,
/// and so are empty lines. A word that is no number, as "nan" is none, gives NaN. `line` is the number of the line
/// before them. Throws InputError at the line for fewer numbers, and naming the file for fewer lines.
std::vector<double> read_text_points(const std::filesystem::path& file, std::string_view text, std::size_t at, int line,
                                     std::size_t count, std::size_t columns);

/// A column of numbers that read_text_points() has read.
PointColumn text_column(const std::vector<double>& numbers, std::size_t columns, std::size_t column);

}  // namespace simvis
