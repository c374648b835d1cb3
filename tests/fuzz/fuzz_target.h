// What is fuzzed: one function for each reader of foreign bytes. The program simvis-fuzz gives them the inputs of
// libFuzzer, corpora_test.cpp those of tests/fuzz/corpora.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace simvis::fuzz {

using Input = std::span<const std::uint8_t>;

/// Reads the input. Returns, or throws an Error, if the input is refused as it should be; everything else is a fault.
using ReadInput = void (*)(Input input);

struct Target {
  std::string_view name;  ///< also of its folder in corpora/ and its dictionary
  ReadInput read;
};

/// All targets, by name.
const std::vector<Target>& targets();

/// Gives the input to the target. An exception that is no refusal of the input goes through: anything but InputError,
/// and MachineError where the target needs a helper program that is not built for fuzzing.
void run_target(const Target& target, Input input);

/// A static object of this type adds a target.
struct TargetRegistration {
  TargetRegistration(std::string_view name, ReadInput read);
};

inline std::string_view text_of(Input input) { return {reinterpret_cast<const char*>(input.data()), input.size()}; }

/// Takes bytes from the front of an input.
class InputBytes {
 public:
  explicit InputBytes(Input input) : rest_(input) {}
  std::uint8_t byte() {
    if (rest_.empty()) return 0;
    const std::uint8_t first = rest_.front();
    rest_ = rest_.subspan(1);
    return first;
  }
  Input rest() const { return rest_; }

 private:
  Input rest_;
};

/// A file with the input in input_folder(), in place of an earlier one of this name.
std::filesystem::path input_file(std::string_view name, Input input);
/// A folder of this process.
std::filesystem::path input_folder();

}  // namespace simvis::fuzz
