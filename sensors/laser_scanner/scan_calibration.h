// Measures what a scan costs on this device, kind of work by kind of work.
//
// A few small rooms are scanned by rendering and by casting, each some times, of which the quickest counts: what else
// the machine does only ever makes things slower. Counts and times together are a system of linear equations, one for
// each room and way; the costs are its least-squares solution in relative errors that has no negative cost (Lawson,
// Hanson, Solving Least Squares Problems, chapter 23; found here by descent along one coordinate after the other).
#pragma once

#include <span>
#include <vector>

#include <simvis/cost_model.h>
#include <simvis/device.h>
#include <simvis/ray_caster.h>

namespace simvis {

/// One measurement: this work took this long.
struct TimedWork {
  CostModel work{};
  double time_ns = 0;
};

/// The costs of the kinds that occur in them, none negative; of others 0.
CostModel fit_costs(std::span<const TimedWork> measurements);

/// Takes some tenths of a second. Throws MachineError as a Renderer does.
CostModel measure_scan_costs(Device& device, RayCaster& rays);

}  // namespace simvis
