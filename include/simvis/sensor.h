// Sensors: they are made by commands as elements are, and give measurements instead of taking parameters.
//
// To add a sensor type, add a pair of files with a class, its attribute table, and one static SensorRegistration; no
// other file changes. A class in a user's own program or in a plug-in library registers in the same way.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/cost_model.h>
#include <simvis/export.h>
#include <simvis/frame_plan.h>
#include <simvis/frame_results.h>
#include <simvis/frame_time.h>
#include <simvis/image.h>
#include <simvis/measurement.h>
#include <simvis/ray_caster.h>
#include <simvis/scan.h>
#include <simvis/sensor_needs.h>
#include <simvis/sensor_report.h>
#include <simvis/sensor_type.h>

namespace simvis {

/// How a measurement depends on earlier frames.
enum class HistoryDependence : std::uint8_t {
  none,          ///< it does not
  poses,         ///< on the poses of the sensor at earlier due frames
  measurements,  ///< on what this or another sensor measured in earlier frames
  /// on these poses, and on what the sensor itself measured in the last frame in which it was due; if that was skipped,
  /// it is measured after all before the next frame that is not
  last_measurement
};

/// A sensor of a scene.
///
/// Frames    the sensor frame: x forward, y left, z up (REP 103); a camera looks along +x.
/// Lifetime  made from its command; check(); then, in each frame in which it is due: begin(), plan(), collect() once
///           the frame has been rendered, and cast(). Destroyed with the simulation. Pointers and spans that getters
///           return are valid as long as the sensor; their content changes with the next measurement.
/// Errors    the constructor and check() throw InputError with the place; cast() may throw InputError.
/// State     a sensor whose history_dependence() is not `none` derives from Stateful too (<simvis/state_archive.h>), so
///           that saved states have what it remembers.
/// Threads   all calls come from the thread that calls the simulation.
class SIMVIS_API Sensor {
 public:
  virtual ~Sensor() = default;

  /// Whether plan() may add views, so that the simulation needs a Vulkan device. It is asked when the sensor is made,
  /// and must not change.
  virtual bool draws() const { return true; }

  /// Throws InputError, with the place, if the device cannot do what the sensor's command requests. It is called if the
  /// sensor draws.
  virtual void check(const TargetLimits&) const {}

  /// Called once before the first plan(), if the type has measure_costs. A sensor that selects a method by predicted
  /// cost keeps the function and calls it when it needs the costs; the first call measures the device unless a file
  /// holds its costs.
  virtual void use_cost_model(const std::function<const CostModel&()>&) {}

  /// Decides whether frames can be skipped, see Simulation::skip_frame().
  virtual HistoryDependence history_dependence() const {
    return visualization() ? HistoryDependence::measurements : HistoryDependence::none;
  }

  /// Called instead of begin() to cast() in a frame that is due but skipped: the sensor may record its pose. sense()
  /// precedes it if needs() has `scene`. begin() to cast() may follow for the same frame, see
  /// HistoryDependence::last_measurement.
  virtual void skip_frame(const FrameTime&, const glm::dmat4& /*world_from_sensor*/) {}

  /// What sense() is to give. It is asked when the sensor is made, and must not change.
  virtual SensorNeeds needs() const { return {}; }

  /// Announces the frame that is planned next.
  virtual void begin(const FrameTime&) {}

  /// Follows begin() if needs() are any. `world` stays valid until the end of cast(), or of skip_frame().
  virtual void sense(const SensedWorld& /*world*/) {}

  /// Adds the views that this frame needs to `plan`. `world_from_sensor` is rigid: scale along the path is removed.
  virtual void plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) = 0;

  /// Reads the rendered results. `results[i]` belongs to `plan.passes[i]`; they are valid during the call only.
  virtual void collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) = 0;

  /// Casts the planned rays into the draw list of this frame; follows collect(). Throws InputError if the requested
  /// accuracy cannot be reached in this frame; what the sensor measured before the exception stays complete.
  virtual void cast(RayCaster&) {}

  /// The last measurement: one array for each output that the sensor's type lists for its command and that is neither
  /// derived nor on request. Before the first one the arrays have no numbers. It shares them with the sensor; nothing
  /// is copied.
  virtual Measurement measurement() const = 0;
  /// Numbers of the last measurement that take long to compute, as OutputSpec::on_request. measurement() has none.
  virtual std::vector<NumberOnRequest> on_request() const { return {}; }
  /// The last scan, which must be that of measurement(); null if the sensor gives none.
  virtual const Scan* scan() const { return nullptr; }
  /// The last reading, which must be that of measurement(); null if the sensor gives none. It has its columns, and no
  /// rows before the first measurement.
  virtual const Reading* reading() const { return nullptr; }

  /// Whether the sensor sees the content that elements draw for people only: beams, paths, graphs.
  virtual bool visualization() const { return false; }

  /// The measuring method for run.json, e.g. "rasterised" or "planar".
  virtual std::string method() const = 0;

  /// Whether the last measurement shows Gaussian splats, which no view draws.
  virtual bool shows_splats() const { return false; }

  /// The report on the last measurement.
  virtual SensorReport report() const { return {}; }

  double rate_hz = 0;  ///< from the attribute `rate`; 0: every frame
};

}  // namespace simvis
