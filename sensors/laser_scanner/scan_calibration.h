// Measures the costs of a scan on this device for each kind of work.
//
// A few small rooms are scanned by rendering and by casting. Each scan runs several times and the shortest time counts,
// because other load on the machine only increases times. Counts and times form a system of linear equations, one for
// each room and method. The costs are the least-squares solution in relative errors without negative costs (Lawson,
// Hanson, Solving Least Squares Problems, chapter 23; found here by coordinate descent).
#pragma once

#include <span>
#include <vector>

#include <simvis/cost_model.h>
#include <simvis/device.h>
#include <simvis/ray_caster.h>

namespace simvis {

/// One measurement: the work and the time that it took.
struct TimedWork {
  CostModel work{};
  double time_ns = 0;
};

/// The costs of the kinds of work that occur in the measurements, none negative; 0 for other kinds.
CostModel fit_costs(std::span<const TimedWork> measurements);

/// Takes some tenths of a second. Throws MachineError under the same conditions as Renderer.
CostModel measure_scan_costs(Device& device, RayCaster& rays);

}  // namespace simvis
