#include "engine/base/temporary_file.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <system_error>
#include <utility>

#include <simvis/error.h>
#include "engine/base/file_writing.h"
#include "engine/base/folder_entries.h"

namespace simvis {

namespace {

constexpr std::string_view kTemporaryEnding = ".tmp";

// Of a name of up to 255 bytes: machine, process and number need a hundred.
constexpr std::size_t kKeptBytes = 128;

// A name that exists already is as rare as a guess that hits one of 2^64 numbers.
constexpr int kNameTries = 8;

std::string machine_name() {
  char machine[HOST_NAME_MAX + 1] = "";
  ::gethostname(machine, sizeof machine - 1);
  return machine;
}

std::uint64_t unguessable_number() {
  std::uint64_t number = 0;
  if (::getrandom(&number, sizeof number, 0) != sizeof number) {
    throw MachineError(std::string("error: the system has no random numbers: ") +
                       std::generic_category().message(errno));
  }
  return number;
}

/// ".MACHINE.PROCESS.": what stands between the name of the target and the random number.
std::string middle_of_name() { return "." + machine_name() + "." + std::to_string(::getpid()) + "."; }

std::string temporary_name_of(const std::filesystem::path& target) {
  return hidden_file_name(target.filename().string(),
                          middle_of_name() + std::to_string(unguessable_number()) + std::string(kTemporaryEnding));
}

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
bool is_of_this_machine(std::string_view before_process) { return before_process.ends_with("." + machine_name()); }

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

TemporaryFile::TemporaryFile(std::filesystem::path target, std::filesystem::path named, int flags)
    : target_(std::move(target)), named_(std::move(named)) {
  struct stat replaced {};
  const bool replaces = ::lstat(target_.c_str(), &replaced) == 0;
  // Only its owner may open it until it has the permissions of the file that it replaces.
  const mode_t mode = replaces ? S_IRUSR | S_IWUSR : 0666;
  for (int tries = 0; descriptor_ < 0; ++tries) {
    hidden_ = target_.parent_path() / temporary_name_of(target_);
    descriptor_ = ::open(hidden_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC | flags, mode);
    if (descriptor_ < 0 && (errno != EEXIST || tries == kNameTries))
      throw_file_error(named_, "cannot be created", errno);
  }
  if (replaces) ::fchmod(descriptor_, replaced.st_mode & 0777);
}

TemporaryFile::~TemporaryFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!hidden_.empty()) ::unlink(hidden_.c_str());
}

void TemporaryFile::close() {
  if (::close(std::exchange(descriptor_, -1)) != 0) throw_file_error(named_, "cannot be written", errno);
}

void TemporaryFile::put_in_place() {
  if (std::rename(hidden_.c_str(), target_.c_str()) != 0)
    throw_file_error(named_, "cannot be renamed into place", errno);
  hidden_.clear();
}

int TemporaryFile::release() { return std::exchange(descriptor_, -1); }

void replace_file(const std::filesystem::path& target, const std::filesystem::path& named, std::string_view bytes) {
  TemporaryFile file(target, named);
  write_all(file.descriptor(), named, bytes);
  file.close();
  file.put_in_place();
}

std::string hidden_file_name(std::string_view name, std::string_view end) {
  std::size_t kept = std::min(name.size(), kKeptBytes);
  const auto continues = [&](std::size_t at) { return (static_cast<unsigned char>(name[at]) & 0xc0) == 0x80; };
  while (kept > 0 && kept < name.size() && continues(kept)) --kept;  // whole characters of UTF-8
  return "." + std::string(name.substr(0, kept)) + std::string(end);
}

void remove_leftovers(const std::filesystem::path& folder, bool own_only) { remove_leftovers(folder, ".", own_only); }

void remove_leftovers_of(const std::filesystem::path& path) {
  const std::filesystem::path folder = path.parent_path();
  const std::string start = hidden_file_name(path.filename().string(), ".");
  remove_leftovers(folder.empty() ? "." : folder, start, true);
}

}  // namespace simvis
