#include "simvis/change_log.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

namespace simvis {

Command logged_command(const std::string& text) { return parse_commands(text, "the log of changes", "").front(); }

std::vector<std::size_t> standing_commands(std::span<const std::string> log) {
  std::vector<std::size_t> standing(log.size());
  std::iota(standing.begin(), standing.end(), std::size_t{0});
  const auto removes = [](const std::string& text) { return text.starts_with("<remove "); };
  if (std::ranges::none_of(log, removes)) return standing;
  std::map<std::pair<std::string, std::string>, std::size_t> made;  // by tag and name, which one object has at a time
  std::vector<bool> stands(log.size(), true);
  for (std::size_t i = 0; i < log.size(); ++i) {
    const Command command = logged_command(log[i]);
    const std::string& name = command.require("name").value;
    if (command.kind == CommandKind::remove) {
      stands[i] = stands[made.at({command.require("kind").value, name})] = false;
    } else {
      made[{std::string(to_string(command.kind)), name}] = i;
    }
  }
  std::erase_if(standing, [&](std::size_t command) { return !stands[command]; });
  return standing;
}

}  // namespace simvis
