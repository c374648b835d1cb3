#include "tests/fuzz/fuzz_target.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <stdexcept>

#include <simvis/error.h>
#include "tests/support/temporary_folder.h"

namespace simvis::fuzz {
namespace {

std::vector<Target>& all_targets() {
  static std::vector<Target> all;
  return all;
}

// The programs that read meshes and pictures are not beside the fuzzing program; their readers are targets of their
// own.
bool is_missing_helper(const std::string& message) { return message.find("cannot start") != std::string::npos; }

}  // namespace

TargetRegistration::TargetRegistration(std::string_view name, ReadInput read) {
  all_targets().push_back({name, read});
  std::ranges::sort(all_targets(), {}, &Target::name);
}

const std::vector<Target>& targets() { return all_targets(); }

void run_target(const Target& target, Input input) {
  try {
    target.read(input);
  } catch (const InputError&) {
    // The input is refused.
  } catch (const MachineError& error) {
    if (!is_missing_helper(error.what())) throw;
  }
}

std::filesystem::path input_folder() {
  static const TemporaryFolder folder;
  return folder.path();
}

std::filesystem::path input_file(std::string_view name, Input input) {
  const std::filesystem::path file = input_folder() / name;
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  if (descriptor < 0) throw std::runtime_error("cannot write " + file.string());
  const ssize_t written = ::write(descriptor, input.data(), input.size());
  ::close(descriptor);
  if (written != static_cast<ssize_t>(input.size())) throw std::runtime_error("cannot write " + file.string());
  return file;
}

}  // namespace simvis::fuzz
