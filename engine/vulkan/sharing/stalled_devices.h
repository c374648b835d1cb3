// Devices without a user whose queues may still work.
#pragma once

#include <memory>

namespace simvis {

class SharedDevice;

/// Closes the device, or keeps it until its queue has ended its work. At the end of the process, devices that draw with
/// threads of the process are waited for, see kExitWait.
void close_or_keep(std::unique_ptr<SharedDevice> device);

/// Closes the kept devices whose queues have ended their work since.
void close_stalled_devices();

}  // namespace simvis
