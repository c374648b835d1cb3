// Outputs of sensors as messages of SimVis's own, and back.
#pragma once

#include <optional>

#include <simvis/measurement.h>
#include "exchange/messages/types/follow_types.h"
#include "exchange/messages/types/output_types.h"

namespace simvis {

ros::Output to_message(const MeasuredArray& array);

/// Empty: the message does not fit together, as a stranger may send it. Of an image, content and view are not known.
std::optional<MeasuredArray> to_array(ros::Output message);

/// Empty: an output does not fit together, or there are more than any sensor has. Whether the outputs fit to one
/// another is checked by fits_together().
std::optional<Measurement> to_measurement(ros::HostMeasurement message);

}  // namespace simvis
