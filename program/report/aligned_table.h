// Tables of text with aligned columns, and cells of CSV.
#pragma once

#include <string>
#include <vector>

namespace simvis {

/// Aligns columns: the first and the last column to the left, the others to the right. All rows have the same number of
/// cells, at least two.
std::string aligned(const std::vector<std::vector<std::string>>& rows);

}  // namespace simvis
