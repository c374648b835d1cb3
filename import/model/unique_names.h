// Names that differ from each other.
#pragma once

#include <algorithm>
#include <map>
#include <string>

namespace simvis {

/// Gives each name once: the second NAME becomes NAME_2.
class UniqueNames {
 public:
  std::string add(const std::string& wanted) {
    if (last_.emplace(wanted, 1).second) return wanted;
    // The last number is kept, so that a file of many equal names takes no more than linear time.
    while (true) {
      std::string name = wanted + "_" + std::to_string(++last_[wanted]);
      if (last_.emplace(name, 1).second) return name;
    }
  }

 private:
  std::map<std::string, int> last_;  // number of the last one of each name
};

/// A name that a sensor of a file may have, which becomes a name of files: with '_' in place of '.' and of control
/// characters, with '/' between names only, and "sensor" if only blanks remain.
inline std::string sensor_name(std::string name) {
  const auto is_replaced = [](char c) { return c == '.' || static_cast<unsigned char>(c) < ' ' || c == '\x7f'; };
  std::ranges::replace_if(name, is_replaced, '_');
  std::string cleaned;
  for (const char c : name) {
    if (c != '/' || (!cleaned.empty() && cleaned.back() != '/')) cleaned += c;
  }
  if (cleaned.ends_with('/')) cleaned.pop_back();
  return cleaned.find_first_not_of(' ') == cleaned.npos ? "sensor" : cleaned;
}

}  // namespace simvis
