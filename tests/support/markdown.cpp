#include "tests/support/markdown.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>

#include "tests/support/temporary_folder.h"

namespace simvis {
namespace {

constexpr std::string_view kFence = "```", kMarkBegin = "<!-- ", kMarkEnd = " -->";

bool read_mark(std::string_view line, std::vector<MarkdownMark>& marks) {
  if (!line.starts_with(kMarkBegin) || !line.ends_with(kMarkEnd)) return false;
  line.remove_prefix(kMarkBegin.size());
  line.remove_suffix(kMarkEnd.size());
  const std::size_t colon = line.find(": ");
  if (colon == line.npos) {
    marks.push_back({std::string(line), ""});
  } else {
    marks.push_back({std::string(line.substr(0, colon)), std::string(line.substr(colon + 2))});
  }
  return true;
}

}  // namespace

std::optional<std::string> MarkdownBlock::mark(std::string_view name) const {
  const auto found = std::ranges::find(marks, name, &MarkdownMark::name);
  return found == marks.end() ? std::nullopt : std::optional(found->value);
}

std::vector<MarkdownBlock> markdown_blocks(const std::filesystem::path& page) {
  std::vector<MarkdownBlock> blocks;
  std::vector<MarkdownMark> marks;
  std::istringstream lines(read_text(page));
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (read_mark(line, marks)) continue;
    if (!line.starts_with(kFence)) {
      if (!line.empty()) marks.clear();
      continue;
    }
    MarkdownBlock block{.language = line.substr(kFence.size()), .text = "", .line = number, .marks = std::move(marks)};
    marks.clear();
    while (std::getline(lines, line) && line != kFence) {
      ++number;
      block.text += line + '\n';
    }
    ++number;
    if (!lines) throw std::runtime_error(page.string() + ":" + std::to_string(block.line) + ": a fence is not closed");
    blocks.push_back(std::move(block));
  }
  return blocks;
}

std::vector<std::filesystem::path> documentation_pages() {
  const std::filesystem::path root = SIMVIS_SOURCE_DIR;
  std::vector<std::filesystem::path> pages{root / "README.md"};
  for (const std::string& file : files_below(root / "docs")) {
    if (file.ends_with(".md")) pages.push_back(root / "docs" / file);
  }
  return pages;
}

}  // namespace simvis
