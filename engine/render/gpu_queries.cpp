#include "engine/render/gpu_queries.h"

#include <array>
#include <cmath>
#include <span>

#include "engine/base/assert.h"
#include "engine/vulkan/vulkan_check.h"

namespace simvis {
namespace {

// Vulkan writes the results in the order of the bits.
constexpr VkQueryPipelineStatisticFlags kCounted =
    VK_QUERY_PIPELINE_STATISTIC_INPUT_ASSEMBLY_VERTICES_BIT |
    VK_QUERY_PIPELINE_STATISTIC_VERTEX_SHADER_INVOCATIONS_BIT | VK_QUERY_PIPELINE_STATISTIC_CLIPPING_INVOCATIONS_BIT |
    VK_QUERY_PIPELINE_STATISTIC_CLIPPING_PRIMITIVES_BIT | VK_QUERY_PIPELINE_STATISTIC_FRAGMENT_SHADER_INVOCATIONS_BIT;
constexpr std::size_t kCounts = 5;

Handle<VkQueryPool> make_pool(DeviceImpl& device, VkQueryType type, std::uint32_t count, const char* name) {
  const VkQueryPoolCreateInfo info{
      .sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
      .pNext = nullptr,
      .flags = 0,
      .queryType = type,
      .queryCount = count,
      .pipelineStatistics = type == VK_QUERY_TYPE_PIPELINE_STATISTICS ? kCounted : VkQueryPipelineStatisticFlags{0}};
  VkQueryPool pool = VK_NULL_HANDLE;
  vk_check(vkCreateQueryPool(device.device, &info, nullptr, &pool), "vkCreateQueryPool");
  return Handle<VkQueryPool>(device, pool, name);
}

// The frame has ended, so there is nothing to wait for.
void read(const DeviceImpl& device, VkQueryPool pool, std::uint32_t first, std::uint32_t count,
          std::span<std::uint64_t> results) {
  device.shared->check(vkGetQueryPoolResults(device.device, pool, first, count, results.size_bytes(), results.data(),
                                             results.size_bytes() / count, VK_QUERY_RESULT_64_BIT),
                       "vkGetQueryPoolResults");
}

}  // namespace

GpuQueries::GpuQueries(DeviceImpl& device)
    : device_(device), timed_(device.physical.timestamp_bits > 0), counted_(device.physical.counts_invocations) {}

void GpuQueries::begin(VkCommandBuffer commands, const FramePlan& plan) {
  std::uint32_t views = 0;
  for (const Pass& pass : plan.passes) views += static_cast<std::uint32_t>(pass.views.size());
  const auto stamps = 2 + 3 * static_cast<std::uint32_t>(plan.passes.size()) + views;
  if (timed_ && stamps > stamps_held_) {
    stamps_ = make_pool(device_, VK_QUERY_TYPE_TIMESTAMP, stamps_held_ = 2 * stamps, "frame stamps");
  }
  const std::uint32_t counts = kDrawPhases * views;
  if (counted_ && counts > counts_held_) {
    statistics_ = make_pool(device_, VK_QUERY_TYPE_PIPELINE_STATISTICS, counts_held_ = 2 * counts, "view statistics");
  }
  if (stamps_) vkCmdResetQueryPool(commands, stamps_.get(), 0, stamps_held_);
  if (statistics_) vkCmdResetQueryPool(commands, statistics_.get(), 0, counts_held_);
  stamp_ = 0;
  drawn_.assign(counts, 0);
  counting_.reset();
  stamp(commands);
}

void GpuQueries::stamp(VkCommandBuffer commands) {
  if (timed_) vkCmdWriteTimestamp(commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, stamps_.get(), stamp_);
  ++stamp_;
}

void GpuQueries::begin_draws(VkCommandBuffer commands, std::size_t view, DrawPhase share) {
  const std::size_t query = kDrawPhases * view + static_cast<std::size_t>(share);
  if (!counted_ || drawn_[query]) return;
  drawn_[query] = 1;
  counting_ = static_cast<std::uint32_t>(query);
  vkCmdBeginQuery(commands, statistics_.get(), *counting_, 0);
}

void GpuQueries::end_draws(VkCommandBuffer commands) {
  if (counting_) vkCmdEndQuery(commands, statistics_.get(), *counting_);
  counting_.reset();
}

// Nanoseconds since the first timestamp. A clock with few valid bits may wrap around during the frame.
std::vector<std::int64_t> GpuQueries::times() const {
  std::vector<std::uint64_t> ticks(stamp_);
  if (timed_) read(device_, stamps_.get(), 0, stamp_, ticks);
  const std::uint32_t bits = device_.physical.timestamp_bits;
  const std::uint64_t mask = bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
  std::vector<std::int64_t> times;
  for (const std::uint64_t tick : ticks) {
    const auto passed = static_cast<double>((tick - ticks.front()) & mask);
    times.push_back(std::llround(passed * static_cast<double>(device_.limits().timestampPeriod)));
  }
  return times;
}

PipelineStatistics GpuQueries::statistics(std::size_t view) const {
  std::array<std::uint64_t, kCounts> sums{};
  for (std::size_t query = kDrawPhases * view; query < kDrawPhases * (view + 1); ++query) {
    if (!drawn_[query]) continue;
    std::array<std::uint64_t, kCounts> counts;
    read(device_, statistics_.get(), static_cast<std::uint32_t>(query), 1, counts);
    for (std::size_t i = 0; i < kCounts; ++i) sums[i] += counts[i];
  }
  const auto& [vertices, vertex_invocations, clipped, drawn, fragments] = sums;
  return {vertices, vertex_invocations, clipped, drawn, fragments};
}

FrameCosts GpuQueries::costs(const FramePlan& plan) const {
  const std::vector<std::int64_t> times = this->times();
  FrameCosts costs{.timed = timed_, .counted = counted_};
  std::size_t stamp = 0;
  const auto span_to_next = [&] {
    ++stamp;
    return GpuSpan{times[stamp - 1], times[stamp]};
  };
  costs.uploads = span_to_next();
  costs.passes.resize(plan.passes.size());
  for (const DrawnPass& drawn : drawing_order(plan)) {
    const Pass& pass = plan.passes[drawn.pass];
    PassCost& cost = costs.passes[drawn.pass];
    cost.time.start_ns = times[++stamp];
    for (std::size_t i = 0; i < pass.views.size(); ++i) {
      cost.views.push_back({span_to_next(), statistics(drawn.first_view + i)});
    }
    cost.time.end_ns = times[++stamp];
    const std::uint64_t pixels = std::uint64_t{pass.width_px} * pass.height_px;
    cost.bytes_read_back = pixels * ((pass.depth ? sizeof(float) : 0) + (pass.color ? 4 * sizeof(float) : 0) +
                                     (pass.has_item_target() ? sizeof(std::uint32_t) : 0));
  }
  for (PassCost& cost : costs.passes) cost.readback = span_to_next();
  SIMVIS_ASSERT(stamp + 1 == times.size());
  return costs;
}

}  // namespace simvis
