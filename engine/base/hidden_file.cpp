#include "engine/base/hidden_file.h"

#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <string>
#include <string_view>

#include <simvis/error.h>
#include "engine/base/folder_entries.h"
#include "engine/base/temporary_name.h"

namespace simvis {

namespace {

constexpr std::string_view kTemporaryEnding = ".tmp";

/// Removes ".DIGITS" from the end of the text and returns the digits; empty if it does not end so.
std::string_view split_number(std::string_view& text) {
  const std::size_t dot = text.rfind('.');
  if (dot == std::string_view::npos) return {};
  const std::string_view digits = text.substr(dot + 1);
  if (digits.empty() || digits.find_first_not_of("0123456789") != std::string_view::npos) return {};
  text.remove_suffix(digits.size() + 1);
  return digits;
}

/// Whether a name that ends before the number of its process is of this machine.
bool is_of_this_machine(std::string_view before_process) {
  std::string own = temporary_name();
  own.resize(own.rfind('.', own.rfind('.') - 1));
  return before_process.ends_with("." + own);
}

bool has_ended(std::string_view process) {
  return ::kill(static_cast<pid_t>(std::strtol(std::string(process).c_str(), nullptr, 10)), 0) != 0 && errno == ESRCH;
}

bool is_leftover(std::string_view name, const std::string& start, bool own_only) {
  if (!name.starts_with(start) || !name.ends_with(kTemporaryEnding)) return false;
  name.remove_suffix(kTemporaryEnding.size());
  if (split_number(name).empty()) return false;
  const std::string_view process = split_number(name);
  return !process.empty() && (is_of_this_machine(name) ? has_ended(process) : !own_only);
}

void remove_leftovers(const std::filesystem::path& folder, const std::string& start, bool own_only) {
  try {
    for (const std::filesystem::path& file : folder_entries(folder)) {
      if (is_leftover(file.filename().string(), start, own_only)) ::unlink(file.c_str());
    }
  } catch (const Error&) {  // the folder cannot be listed
  }
}

}  // namespace

std::filesystem::path hidden_name(const std::filesystem::path& path) {
  return path.parent_path() / ("." + path.filename().string() + "." + temporary_name() + std::string(kTemporaryEnding));
}

void remove_leftovers(const std::filesystem::path& folder, bool own_only) { remove_leftovers(folder, ".", own_only); }

void remove_leftovers_of(const std::filesystem::path& path) {
  const std::filesystem::path folder = path.parent_path();
  remove_leftovers(folder.empty() ? "." : folder, "." + path.filename().string() + ".", true);
}

}  // namespace simvis
