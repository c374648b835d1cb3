// Descriptions of pipelines for the frame plan.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <simvis/frame_plan.h>
#include "engine/render/frame_draw_lists.h"

namespace simvis {

/// Describes the pipelines of the draws of a view, in the order of drawing. `made` holds the PipelineKey::bits() of the
/// pipelines created in this frame. A key that is found is removed, so that a pipeline is reported as created only at
/// its first use.
std::vector<PlannedPipeline> describe_pipelines(std::span<const DrawRun> runs, const Pass& pass,
                                                std::vector<std::uint64_t>& made);

/// Describes the pipeline that averages the samples of a pass. `made` holds values of ResolvePass::pipeline_key() and
/// is used as above.
PlannedPipeline describe_resolve(const Pass& pass, std::vector<std::uint32_t>& made);

}  // namespace simvis
