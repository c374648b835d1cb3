// Outputs of sensors as messages of SimVis's own, and back.
#pragma once

#include <optional>

#include <simvis/measurement.h>
#include "messages/types/output_types.h"

namespace simvis {

ros::Output to_message(const MeasuredArray& array);

/// Empty: the message does not fit together, as a stranger may send it. Of an image, content and view are not known.
std::optional<MeasuredArray> to_array(ros::Output message);

}  // namespace simvis
