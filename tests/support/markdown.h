// The fenced blocks of a Markdown page and the marks that tests use.
//
// A mark is an HTML comment of its own line before the fence, several marks are several lines:
//   <!-- file: NAME -->       the block is written to NAME before the commands that follow it are run
//   <!-- same as: FILE -->    the block is the content of FILE, relative to the root of the sources
//   <!-- not run: REASON -->  the commands cannot be run in a test, or the block is only a piece of something
//   <!-- output -->           what the commands of the block before print; "..." stands for any text within a line
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace simvis {

struct MarkdownMark {
  std::string name, value;
};

struct MarkdownBlock {
  std::string language;  ///< as written behind the fence; may be empty
  std::string text;      ///< with a line break behind each line
  std::size_t line = 0;  ///< of the opening fence, from 1
  std::vector<MarkdownMark> marks;

  std::optional<std::string> mark(std::string_view name) const;
};

/// In the order of the page. Throws std::runtime_error if a fence is not closed.
std::vector<MarkdownBlock> markdown_blocks(const std::filesystem::path& page);

/// README.md and all pages below docs/, sorted.
std::vector<std::filesystem::path> documentation_pages();

}  // namespace simvis
