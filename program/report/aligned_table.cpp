#include "program/report/aligned_table.h"

#include <algorithm>

#include "engine/base/assert.h"

namespace simvis {

std::string aligned(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths(rows.front().size());
  for (const std::vector<std::string>& row : rows) {
    SIMVIS_ASSERT(row.size() == widths.size());
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], row[c].size());
  }
  std::string text;
  for (const std::vector<std::string>& row : rows) {
    std::string line = row.front() + std::string(widths.front() - row.front().size(), ' ');
    for (std::size_t c = 1; c + 1 < row.size(); ++c)
      line += "  " + std::string(widths[c] - row[c].size(), ' ') + row[c];
    line += "  " + row.back();
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + '\n';
  }
  return text;
}

}  // namespace simvis
