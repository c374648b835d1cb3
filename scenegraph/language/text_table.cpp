#include "scenegraph/language/text_table.h"

#include <algorithm>

namespace simvis {
namespace {

constexpr std::size_t kWidth = 100;
constexpr std::size_t kNarrowestText = 30;

void end_line(std::string& page, std::string line) {
  line.erase(line.find_last_not_of(' ') + 1);
  page += line + "\n";
}

std::string markdown_row(const TextRow& row) {
  std::string line = "|";
  for (const std::string& cell : row) line += cell.empty() ? " |" : ' ' + cell + " |";
  return line + '\n';
}

}  // namespace

void add_wrapped(std::string& page, std::string line, std::size_t indent, std::string_view text) {
  const std::size_t room = std::max(kWidth - std::min(kWidth, indent), kNarrowestText);
  while (text.size() > room) {
    std::size_t cut = text.rfind(' ', room);
    if (cut == std::string_view::npos) cut = std::min(text.find(' '), text.size());
    end_line(page, line + std::string(text.substr(0, cut)));
    text.remove_prefix(std::min(cut + 1, text.size()));
    line.assign(indent, ' ');
  }
  end_line(page, line + std::string(text));
}

std::string text_table(std::span<const TextRow> rows) {
  if (rows.empty()) return "";
  const std::size_t last = rows.front().size() - 1;
  std::vector<std::size_t> widths(last);
  for (const TextRow& row : rows) {
    for (std::size_t c = 0; c < last; ++c) widths[c] = std::max(widths[c], row[c].size());
  }
  std::string page;
  for (const TextRow& row : rows) {
    std::string line;
    std::size_t indent = 0;
    for (std::size_t c = 0; c < last; ++c) {
      line += row[c];
      indent += widths[c] + 2;
      line.resize(std::max(line.size(), indent), ' ');
    }
    add_wrapped(page, line, indent, row[last]);
  }
  return page;
}

std::string markdown_rows(const TextRow& heads, std::span<const TextRow> rows) {
  std::string page = markdown_row(heads), rule = "|";
  for (std::size_t c = 0; c < heads.size(); ++c) rule += "---|";
  page += rule + '\n';
  for (const TextRow& row : rows) page += markdown_row(row);
  return page;
}

}  // namespace simvis
