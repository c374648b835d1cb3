#include "import/programs/reported_faults.h"

#include <exception>
#include <new>
#include <string_view>
#include <system_error>

#include <simvis/error.h>
#include "engine/base/read_error.h"
#include "import/programs/failed_allocations.h"
#include "import/sandbox/sandbox_process.h"

namespace simvis {
namespace {

bool is_of_the_machine(const std::system_error& error) {
  const std::error_category& category = error.code().category();
  const bool has_number = category == std::generic_category() || category == std::system_category();
  return has_number && !is_fault_of_file(error.code().value());
}

// Readers that get no subject for their messages begin them with a space.
void report(AnswerWriter& answer, AnswerKind kind, std::string_view reason) {
  answer.add(kind, reason.substr(reason.starts_with(' ') ? 1 : 0));
}

}  // namespace

void report_faults(AnswerWriter& answer, const std::string& takes, const std::string& advice,
                   const ProcessLimits& limits, const std::function<void()>& work) {
  const std::string memory =
      takes + " more than " + std::to_string(limits.memory_bytes >> 20) + " MiB of memory" + advice;
  report_failed_allocations(kAnswerDescriptor, memory);
  try {
    limit_process(limits);
    work();
  } catch (const std::bad_array_new_length&) {
    report(answer, AnswerKind::refusal, "claims more content than any memory holds");
  } catch (const std::bad_alloc&) {
    report(answer, AnswerKind::machine, memory);
  } catch (const MachineError& error) {
    report(answer, AnswerKind::machine, error.what());
  } catch (const std::system_error& error) {
    report(answer, is_of_the_machine(error) ? AnswerKind::machine : AnswerKind::refusal, error.what());
  } catch (const std::exception& error) {
    report(answer, AnswerKind::refusal, error.what());
  } catch (...) {
    report(answer, AnswerKind::refusal, "an unknown exception");
  }
}

}  // namespace simvis
