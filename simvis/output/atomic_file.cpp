#include "simvis/output/atomic_file.h"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <system_error>

#include <simvis/error.h>
#include "engine/base/assert.h"
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

/// Whether a file of this name, without its last number, was made by a process of this machine that has ended.
bool made_by_ended_process(std::string_view before_process, std::string_view process) {
  std::string own = temporary_name();
  own.resize(own.rfind('.', own.rfind('.') - 1));  // the machine
  if (!before_process.ends_with("." + own)) return false;
  return ::kill(static_cast<pid_t>(std::strtol(std::string(process).c_str(), nullptr, 10)), 0) != 0 && errno == ESRCH;
}

bool is_leftover(std::string_view name, bool ended_only) {
  if (!name.starts_with('.') || !name.ends_with(kTemporaryEnding)) return false;
  name.remove_suffix(kTemporaryEnding.size());
  if (split_number(name).empty()) return false;
  const std::string_view process = split_number(name);
  return !process.empty() && (!ended_only || made_by_ended_process(name, process));
}

}  // namespace

void throw_file_error(const std::filesystem::path& path, const char* what, int error) {
  throw MachineError(path.string() + ": error: " + what + ": " + std::generic_category().message(error));
}

std::filesystem::path hidden_name(const std::filesystem::path& path) {
  return path.parent_path() / ("." + path.filename().string() + "." + temporary_name() + std::string(kTemporaryEnding));
}

void remove_leftovers(const std::filesystem::path& folder, bool ended_only) {
  std::error_code error;
  std::filesystem::directory_iterator files(folder, error), end;
  for (; !error && files != end; files.increment(error)) {
    if (is_leftover(files->path().filename().string(), ended_only)) ::unlink(files->path().c_str());
  }
}

void write_all(int descriptor, const std::filesystem::path& path, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw_file_error(path, "cannot be written", errno);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

AtomicFile::AtomicFile(std::filesystem::path path) : path_(std::move(path)) {
  temporary_ = hidden_name(path_);
  descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) throw_file_error(path_, "cannot be created", errno);
}

AtomicFile::~AtomicFile() {
  if (temporary_.empty()) return;
  if (descriptor_ >= 0) ::close(descriptor_);
  ::unlink(temporary_.c_str());
}

void AtomicFile::write(std::string_view bytes) {
  SIMVIS_ASSERT(descriptor_ >= 0);
  write_all(descriptor_, path_, bytes);
}

void AtomicFile::commit() {
  SIMVIS_ASSERT(descriptor_ >= 0);
  // Some file systems report a full disk only at close().
  const int closed = ::close(descriptor_);
  descriptor_ = -1;
  if (closed != 0) throw_file_error(path_, "cannot be written", errno);
  if (std::rename(temporary_.c_str(), path_.c_str()) != 0)
    throw_file_error(path_, "cannot be renamed into place", errno);
  temporary_.clear();
}

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw MachineError(folder.string() + ": error: the folder cannot be created: " + error.message());
}

void write_file(const std::filesystem::path& path, std::string_view bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
}

}  // namespace simvis
