// Pipelines in words, for the frame plan.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/frame_draws.h"
#include "engine/frame_plan.h"

namespace simvis {

/// Those of a view's draws, in the order of drawing; `made` are the PipelineKey::bits() of those that are new.
std::vector<PlannedPipeline> pipelines_of(std::span<const DrawRun> runs, const Pass& pass,
                                          std::span<const std::uint32_t> made);

/// The one that takes the mean of a pass's samples.
PlannedPipeline mean_in_words(const Pass& pass);

}  // namespace simvis
