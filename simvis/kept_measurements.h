// Measurements that a caller keeps beyond the next one, without a copy: see Simulation::keep().
//
// A sensor overwrites its images and its scan in place. What is kept moves out of the sensor before that happens, with
// its memory, so that its address stays; the sensor gets memory that nobody keeps any more.
#pragma once

#include <atomic>
#include <cstddef>
#include <map>
#include <memory>
#include <vector>

#include "simvis/scene_builder.h"

namespace simvis {

/// The numbers of one measurement of one sensor: at first in the sensor, later here.
class KeptMeasurement {
 public:
  explicit KeptMeasurement(const Sensor& sensor);

  /// While any copy of it lives, the numbers stay. It may be released in any thread.
  std::shared_ptr<const void> lease(const std::shared_ptr<KeptMeasurement>& self);
  bool is_leased() const { return leases_.load(std::memory_order_acquire) > 0; }
  /// Of the numbers that are here.
  std::size_t bytes() const;

  /// Moves the numbers here. The sensor gets the memory of `spare`, if there is one, with the old numbers in it: a
  /// vector that keeps its size is not cleared before it is written.
  void take(KeptMeasurement* spare);
  /// Undoes take(): what the sensor has written since then is lost.
  void give_back();
  /// As take(), but the sensor has the same numbers in other memory.
  void take_and_leave_copy();

 private:
  struct Lease;
  struct Floats {
    std::vector<float>* in_sensor;
    std::vector<float> here{};
  };

  std::vector<Floats> floats_;
  std::vector<ScanChannel>* channels_in_sensor_ = nullptr;  // null: the sensor gives no scan
  std::vector<ScanChannel> channels_;
  std::atomic<int> leases_ = 0;
  std::weak_ptr<const void> lease_;
};

/// What is kept of one sensor.
struct Kept {
  std::shared_ptr<KeptMeasurement> last;                 // its numbers are in the sensor; null: nobody asked
  std::vector<std::shared_ptr<KeptMeasurement>> before;  // earlier ones, and a spare one that nobody keeps any more

  std::shared_ptr<KeptMeasurement> take_spare();  // null: there is none
  void drop_spares();                             // all but one
};

/// The kept measurements of all sensors of a simulation.
///
/// Threads  as the simulation; leases may be released in any thread.
class KeptMeasurements {
 public:
  KeptMeasurements() = default;
  ~KeptMeasurements();  ///< while the sensors still exist
  KeptMeasurements(const KeptMeasurements&) = delete;
  KeptMeasurements& operator=(const KeptMeasurements&) = delete;

  std::shared_ptr<const void> keep(const BuiltSensor& sensor);
  /// Memory that is not the sensors' own: of what is kept, and of at most one spare measurement for each sensor.
  std::size_t bytes() const;

  /// Stands around a measurement of a sensor. Without done(), the sensor has failed and gets its numbers back.
  class Overwriting {
   public:
    Overwriting(KeptMeasurements& kept, const BuiltSensor& sensor);
    ~Overwriting();
    /// The sensor has written all of its numbers.
    void done();
    Overwriting(const Overwriting&) = delete;
    Overwriting& operator=(const Overwriting&) = delete;

   private:
    Kept* kept_ = nullptr;
  };

  /// Before sensors may be removed: nothing that is kept depends on a sensor any more.
  void leave_sensors();

 private:
  friend class Overwriting;
  std::map<std::size_t, Kept> of_;  // by BuiltSensor::id
};

}  // namespace simvis
