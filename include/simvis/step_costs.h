// What a step did: which sensors were due and what they planned, and the time of its stages and of each sensor.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace simvis {

/// One stage of a step, on the steady clock. "render" ends when the GPU has finished and host-only ray casts are
/// complete; with step_async() it includes what the caller did between the two halves.
struct StageTime {
  std::string_view name;      ///< "elements", "flatten", "plan", "render", "collect" or "visualization"
  std::int64_t start_ns = 0,  ///< begin of the stage
      end_ns = 0;             ///< end of the stage
};

/// Whether a sensor measures in a frame, and why not.
enum class DueState : std::uint8_t {
  due,      ///< it measures
  off,      ///< it is turned off
  waiting,  ///< its rate puts its next measurement at a later frame
  hidden,   ///< it stands in a part that is switched off
};

/// The share of a sensor, due or not, in a FramePlan.
struct PlannedSensor {
  std::string name,                    ///< the sensor's name
      type;                            ///< its type
  DueState due_state = DueState::due;  ///< whether it measures in this frame
  double rate_hz = 0;                  ///< 0: every frame
  std::vector<std::string> outputs{};  ///< outputs that it produces
  std::size_t first_pass = 0,          ///< its passes are [first_pass, end_pass) of the plan
      end_pass = 0;                    ///< one past its last pass
  std::size_t first_cast = 0,          ///< its casts are [first_cast, end_cast) of the plan
      end_cast = 0;                    ///< one past its last cast
};

/// The host cost of one sensor in one frame. Times are of the steady clock, in ascending order.
struct SensorCost {
  std::string sensor;             ///< the sensor's name
  std::int64_t start_ns = 0;      ///< before it reads the results of its passes
  std::int64_t collected_ns = 0;  ///< after it has read these results
  std::int64_t end_ns = 0;        ///< after it has cast its rays, if it casts any
  std::uint64_t rays = 0;         ///< rays cast, see RayCounters
  std::uint64_t item_tests = 0,   ///< see RayCounters
      triangle_tests = 0;         ///< see RayCounters
};

}  // namespace simvis
