// Runs code that broken input may crash or hang, such as another project's file reader, in a process of its own.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace simvis {

struct ChildLimits {
  std::chrono::milliseconds time{10'000};
  std::size_t memory_bytes = std::size_t{4} << 30;  ///< beyond what the parent has; not enforced under AddressSanitizer
};

enum class ChildEnd : std::uint8_t {
  finished,      ///< `result` is what the work returned
  threw,         ///< `reason` is the exception's text
  crashed,       ///< `reason` names the signal
  took_too_long  ///< it was killed
};

struct ChildReport {
  ChildEnd end = ChildEnd::crashed;
  std::string reason;
  std::vector<std::uint8_t> result;  ///< to be trusted as little as a file
  std::vector<std::string> log;      ///< lines, also of a child that crashed; cut off after 64 KiB
};

/// Where the work writes lines that outlive a crash.
class ChildLog {
 public:
  explicit ChildLog(int file) : file_(file) {}
  /// Control characters in `line` become spaces, and where it is not UTF-8, all that is not ASCII becomes '?'.
  void add(std::string_view line);

 private:
  int file_;
  std::size_t bytes_ = 0;
};

using ChildWork = std::function<std::vector<std::uint8_t>(ChildLog& log)>;

/// Forks, runs `work` in the child, and waits for it. The child's standard streams lead nowhere, what it changes in
/// memory is lost, and its destructors and exit handlers do not run.
/// Throws MachineError where there can be no child.
ChildReport run_in_child(const ChildWork& work, const ChildLimits& limits = {});

}  // namespace simvis
