// The exception of a consumer of frames.
#pragma once

#include <simvis/error.h>
#include <simvis/export.h>

namespace simvis {

/// A consumer of frames has failed: the shared memory, the recording, DDS, or the program's own. The frame itself is
/// made: its measurements, time and counts are those of a run without this consumer. `what()` names the consumer and
/// its reason; if several have failed at one frame, all of them: "recording: REASON; DDS: REASON".
class SIMVIS_API OutletError : public MachineError {
 public:
  using MachineError::MachineError;
};

}  // namespace simvis
