#include "program/options/help_formatter.h"

#include <sstream>
#include <utility>

namespace simvis {
namespace {

constexpr std::size_t kTextColumn = 30, kLastColumn = 100;

// The name of an option with its value and default, such as "--frames N=1".
std::string signature(const CLI::Option& option, bool is_positional) {
  std::string text = "  " + option.get_name(is_positional, !is_positional);
  if (is_positional || option.get_type_size() == 0) return text;
  if (!option.get_option_text().empty()) return text + " " + option.get_option_text();
  // A check on a set of words appends the set to the type's name, which has these words already.
  const std::string type = option.get_type_name();
  text += " " + type.substr(0, type.find(":{"));
  if (!option.get_default_str().empty()) text += "=" + option.get_default_str();
  return text;
}

}  // namespace

HelpFormatter::HelpFormatter() { column_width(kTextColumn); }

// One empty line between two groups; CLI11 puts two there, and one behind the positional arguments.
std::string HelpFormatter::make_group(std::string title, bool is_positional,
                                      std::vector<const CLI::Option*> options) const {
  const std::string group = CLI::Formatter::make_group(std::move(title), is_positional, std::move(options));
  return is_positional ? group + '\n' : group.substr(1);
}

std::string HelpFormatter::make_option(const CLI::Option* option, bool is_positional) const {
  std::string text = signature(*option, is_positional);
  std::size_t column = text.size();
  if (column + 2 > kTextColumn) {
    text += '\n';
    column = 0;
  }
  text.append(kTextColumn - column, ' ');
  column = kTextColumn;
  std::istringstream words(option->get_description());
  bool first = true;
  for (std::string word; words >> word; first = false) {
    if (!first && column + 1 + word.size() > kLastColumn) {
      text += '\n' + std::string(kTextColumn, ' ');
      column = kTextColumn;
    } else if (!first) {
      text += ' ';
      ++column;
    }
    text += word;
    column += word.size();
  }
  return text + '\n';
}

}  // namespace simvis
