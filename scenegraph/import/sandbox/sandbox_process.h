// Runs a program that broken input may crash or hang, and reads its answer.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace simvis {

/// The file descriptor for the answer of a program that is made for SimVis.
inline constexpr int kAnswerDescriptor = 3;

/// The streams that make the answer. The program has no other open files than these and its standard streams, which are
/// /dev/null unless they are the answer.
enum class AnswerStreams : std::uint8_t {
  own,               ///< kAnswerDescriptor
  output_and_errors  ///< standard output and standard error, mixed
};

struct SandboxCall {
  std::filesystem::path program;
  std::string_view purpose = "reads part files";  ///< of the program, for messages
  std::vector<std::string> arguments;             ///< without the program's name
  std::vector<std::string> environment{};         ///< NAME=VALUE, in addition to this process's or instead of its value
  std::span<const std::uint8_t> input{};          ///< standard input, a file in memory; empty: /dev/null
  AnswerStreams streams = AnswerStreams::own;
  std::chrono::milliseconds time{10'000};
  std::size_t answer_bytes = std::size_t{4} << 30;
};

enum class SandboxEnd : std::uint8_t {
  finished,             ///< with exit status 0
  crashed,              ///< `reason` names the signal or the exit status
  took_too_long,        ///< killed at the time limit
  answered_without_end  ///< killed after `answer_bytes`
};

struct SandboxReport {
  SandboxEnd end = SandboxEnd::crashed;
  std::string reason;
  std::vector<std::uint8_t> answer;  ///< everything that the program wrote, however it ended; not trusted
};

/// Starts the program and waits until it ends or is killed. Several threads may call this function at the same time.
/// Throws MachineError naming the program if it is missing or cannot be started.
SandboxReport run_in_sandbox(const SandboxCall& call);

}  // namespace simvis
