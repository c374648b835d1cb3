#include "python/core/free_work.h"

#include <sys/types.h>
#include <unistd.h>

#include <thread>

namespace nb = nanobind;

namespace simvis::python {
namespace {

// All are guarded by the interpreter's lock.
unsigned inside = 0;                      // calls that have not returned
pid_t process_of_calls = 0;               // a forked process has one of its threads
std::optional<std::thread::id> ends_all;  // the thread that ends the interpreter

unsigned& own_calls() {
  if (process_of_calls != ::getpid()) inside = 0;
  process_of_calls = ::getpid();
  return inside;
}

}  // namespace

bool InsideModule::may_enter() { return !ends_all || *ends_all == std::this_thread::get_id(); }

InsideModule::InsideModule() { ++own_calls(); }

InsideModule::~InsideModule() {
  if (unsigned& own = own_calls(); own > 0) --own;  // a fork within the call has set it to 0
}

ModuleCall::ModuleCall() {
  if (InsideModule::may_enter()) return;
  PyErr_SetNone(PyExc_SystemExit);
  throw nb::python_error();
}

void bind_free_work(nb::module_& module) {
  module.def(
      "begin_end", [] { ends_all = std::this_thread::get_id(); }, "From now on only this thread may enter.");
  module.def(
      "is_inside", [] { return own_calls() > 0; }, "Whether a thread is inside the module.");
}

}  // namespace simvis::python
