#include "sensors/beam_tables/beam_table.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "engine/base/assert.h"

namespace simvis {
namespace {

// The number of rings if every channel has equally many beams; otherwise 1.
std::uint32_t rings_of(const std::vector<TableBeam>& beams) {
  std::map<std::uint32_t, std::size_t> counts;
  for (const TableBeam& beam : beams) {
    if (!beam.channel) return 1;
    ++counts[*beam.channel];
  }
  const bool even =
      std::ranges::all_of(counts, [&](const auto& each) { return each.second == counts.begin()->second; });
  return even ? static_cast<std::uint32_t>(counts.size()) : 1;
}

}  // namespace

BeamTable make_beam_table(const std::vector<TableBeam>& beams) {
  SIMVIS_ASSERT(!beams.empty() && beams.size() <= kMaxTableBeams);
  BeamTable table{.rings = rings_of(beams)};
  table.beams = static_cast<std::uint32_t>(beams.size() / table.rings);
  std::vector<std::size_t> order(beams.size());
  std::iota(order.begin(), order.end(), 0);
  if (table.rings > 1) {
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return *beams[i].channel; });
  }
  const bool moved = std::ranges::any_of(beams, [](const auto& beam) { return beam.origin_m != glm::dvec3(0); });
  for (const std::size_t i : order) {
    const TableBeam& beam = beams[i];
    table.azimuth_deg.push_back(beam.azimuth_deg);
    table.elevation_deg.push_back(beam.elevation_deg);
    if (moved) table.origin_m.push_back(beam.origin_m);
    if (beam.time_ns) table.time_ns.push_back(*beam.time_ns);
    if (beam.channel) table.channel.push_back(*beam.channel);
  }
  SIMVIS_ASSERT(table.time_ns.empty() || table.time_ns.size() == table.size());
  SIMVIS_ASSERT(table.channel.empty() || table.channel.size() == table.size());
  if (!table.time_ns.empty()) {
    const std::int64_t first_ns = *std::ranges::min_element(table.time_ns);
    for (std::int64_t& time_ns : table.time_ns) time_ns -= first_ns;
  }
  return table;
}

}  // namespace simvis
