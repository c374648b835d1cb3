// Runs a program that broken input may crash or hang, and reads its answer.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "import/sandbox/growing_bytes.h"
#include "import/sandbox/helper_end.h"

namespace simvis {

/// The file descriptor for the answer of the program. It has no other open files than this and its standard streams,
/// which are /dev/null but for the input.
inline constexpr int kAnswerDescriptor = 3;

struct SandboxCall {
  std::filesystem::path program;
  std::string_view purpose = "reads part files";  ///< of the program, for messages
  std::vector<std::string> arguments;             ///< without the program's name
  std::vector<std::string> environment{};         ///< NAME=VALUE, in addition to this process's or instead of its value
  bool inherits_environment = true;               ///< false: the program has `environment` alone
  std::span<const std::uint8_t> input{};          ///< standard input, a file in memory; empty: /dev/null
  std::chrono::milliseconds time{10'000};         ///< of its processor, so that a busy machine does not end it
  std::chrono::milliseconds wall_time{600'000};   ///< by the clock, for a program that waits for ever
  std::size_t answer_bytes = std::size_t{4} << 30;
};

struct SandboxReport {
  HelperEnd end;
  GrowingBytes answer;  ///< everything that the program wrote, however it ended; not trusted
};

/// Starts the program in a process group of its own and waits until it ends or is killed at a limit; then its group is
/// killed, so that no process that it has started goes on. Several threads may call this function at the
/// same time. Signals of the terminal, such as Ctrl-C, do not reach the program.
/// Throws MachineError naming the program if it is missing or cannot be started.
SandboxReport run_in_sandbox(const SandboxCall& call);

}  // namespace simvis
