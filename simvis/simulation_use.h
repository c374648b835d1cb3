// Access to the state of a simulation during one call.
#pragma once

#include <thread>

#include <simvis/error.h>
#include "simvis/simulation_impl.h"

namespace simvis {

/// While it exists, calls from other threads are refused. A call within a call, from the same thread, is allowed: a
/// progress callback may make one.
class SimulationUse {
 public:
  /// Throws InputError if `impl` is null, which means that the simulation was moved from, if it is in use by another
  /// thread, or if this process was forked from the one that loaded it.
  explicit SimulationUse(SimulationImpl* impl) : impl_(impl) {
    if (impl == nullptr) {
      throw InputError("this simulation was moved from, expected one that was loaded or assigned to");
    }
    impl->process.require_not_forked();
    const std::thread::id self = std::this_thread::get_id();
    std::thread::id user;
    outermost_ = impl->user.compare_exchange_strong(user, self);
    if (!outermost_ && user != self) {
      throw InputError("another thread is using this simulation, expected one thread at a time");
    }
  }
  ~SimulationUse() {
    if (outermost_) impl_->user.store({});
  }
  SimulationUse(const SimulationUse&) = delete;
  SimulationUse& operator=(const SimulationUse&) = delete;

  SimulationImpl* operator->() const { return impl_; }
  SimulationImpl& operator*() const { return *impl_; }

 private:
  SimulationImpl* impl_;
  bool outermost_;
};

}  // namespace simvis
