// Pipelines in words, for the frame plan.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <simvis/frame_plan.h>
#include "engine/render/frame_draw_lists.h"

namespace simvis {

/// Those of a view's draws, in the order of drawing. Where one is in `made`, of PipelineKey::bits(), it is taken out of
/// there: the first who needs it has it made.
std::vector<PlannedPipeline> describe_pipelines(std::span<const DrawRun> runs, const Pass& pass,
                                                std::vector<std::uint64_t>& made);

/// The one that takes the mean of a pass's samples; `made` likewise, of ResolvePass::pipeline_key().
PlannedPipeline mean_pipeline(const Pass& pass, std::vector<std::uint32_t>& made);

}  // namespace simvis
