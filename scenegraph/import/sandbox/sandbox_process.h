// Runs a program that broken input may crash or hang, and takes what it answers.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace simvis {

/// Where the program writes its answer. It has no other files open: its standard streams lead nowhere.
inline constexpr int kAnswerDescriptor = 3;

struct SandboxCall {
  std::filesystem::path program;
  std::vector<std::string> arguments;  ///< without the program's name
  std::chrono::milliseconds time{10'000};
  std::size_t answer_bytes = std::size_t{4} << 30;
};

enum class SandboxEnd : std::uint8_t {
  finished,             ///< with exit status 0
  crashed,              ///< `reason` names the signal or the exit status
  took_too_long,        ///< it was killed
  answered_without_end  ///< it was killed after `answer_bytes`
};

struct SandboxReport {
  SandboxEnd end = SandboxEnd::crashed;
  std::string reason;
  std::vector<std::uint8_t> answer;  ///< all that it wrote, however it ended; not to be trusted
};

/// Starts the program and waits for its end, whatever it does. May be called from several threads at a time.
/// Throws MachineError naming the program when it is missing or cannot be started.
SandboxReport run_in_sandbox(const SandboxCall& call);

}  // namespace simvis
