// What was rendered, why, and what it cost, for people.
#pragma once

#include <string>

#include "engine/frame_plan.h"
#include "engine/renderer.h"

namespace simvis {

/// One line per pass and per view with its reason, then the counters of the frame.
std::string explain(const FramePlan& plan, const FrameCounters& counters);

}  // namespace simvis
