// What the sensors of one audience do not see: the items that their attribute `ignore` names, or else those of their
// own link that contain them; and the items whose visibility flags share no bit with their attribute `visibility_mask`.
//
//   <sensor type="laser_scanner" name="LIDAR" insert_at="laser" ignore="laser base_link HOUSING"/>
//
// Names    objects of the scene, by names, paths and patterns. A part or a model stands for its whole file, not for
//          what is inserted there. "none": the sensor sees everything.
// Default  a sensor does not see the shapes of its own link that contain its origin. The own link is the object at
//          which the sensor is inserted; if it has no shapes, the next one above it in the same part that has. Shapes
//          that are open, transparent to lasers, or nearer than a camera's `near` are not left out, and neither is a
//          solid whose box contains the middles of most shapes of other parts: it is a room.
// Masks    the element `visibility_flags` gives shapes their flags (elements/visibility_flags.h).
// When     the items are found again whenever the graph is traversed anew: when the scene changes, not when objects
//          move.
// Effects  the sensor's views and rays leave the items out, and its draw list has them invisible. So no output of the
//          sensor shows them: no depth, colour, id, box, silhouette or echo. Items keep their numbers and ids. Lights
//          do not know of it: ignored items cast shadows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/frame_plan.h>
#include "engine/base/program_api.h"
#include "scenegraph/flattener.h"
#include "simvis/scene_builder.h"

namespace simvis {

/// Attributes of all sensors that see, and the word of the first one for nothing.
inline constexpr std::string_view kIgnore = "ignore", kIgnoreNone = "none", kVisibilityMask = "visibility_mask";

/// A solid that a sensor sees from inside.
struct SolidAround {
  const BuiltSensor* sensor = nullptr;
  std::string point;  ///< the insertion point of its shape
  std::string mesh;   ///< the name of its mesh; may be empty
};

/// The sensors that stand inside a visible, opaque solid that they do not ignore and see in a quarter of all
/// directions, each with the first such solid of the scene as it stands. A camera whose near distance leaves out the
/// whole solid is not among them. `threads` as SimulationDesc::threads.
SIMVIS_PROGRAM_API std::vector<SolidAround> seen_solids_around(const BuiltScene& built, unsigned threads);

/// The items of the draw list of sensors, as the scene stands now, that a sensor does not see, ascending.
SIMVIS_PROGRAM_API std::vector<std::uint32_t> unseen_items(const BuiltScene& built, const BuiltSensor& sensor);

class IgnoredItems {
 public:
  explicit IgnoredItems(Audience audience) : audience_(audience) {}

  /// Follows the flattener's update(); costs nothing unless the graph was traversed anew. `warn` gets a line for each
  /// name without an object.
  void update(const BuiltScene& built, const Flattener& flattener, const DrawList& list,
              const std::function<void(const std::string&)>& warn);

  /// The items that the sensor of this BuiltSensor::id does not see, ascending; empty: it sees all. Valid until the
  /// next update().
  std::span<const std::uint32_t> of(std::size_t sensor) const;

  /// The list as the sensor sees it: `list` itself, or a copy in which the items are not visible. Valid until the next
  /// call for the sensor.
  const DrawList& seen_list(std::size_t sensor, const DrawList& list);

  /// The number of views of each pass.
  static std::vector<std::size_t> count_views(const FramePlan& plan);
  /// Lets the views and casts that the sensor has added to the plan since leave its items out. `views` and `casts` are
  /// the numbers from before. Returns the warning about shapes of its own link with its first view or cast: sensors
  /// such as an `imu` look at nothing. Empty: there is none.
  std::string leave_out(std::size_t sensor, std::span<const std::size_t> views, std::size_t casts, FramePlan& plan);

 private:
  struct Ignoring {
    std::shared_ptr<const std::vector<std::uint32_t>> items;
    std::string warning{};  // of shapes of its own link, until its first view or ray
    DrawList seen{};
    bool is_made = false;
  };
  Audience audience_;
  std::uint64_t rebuilds_ = 0;               // of the flattener, at the last update()
  std::map<std::size_t, Ignoring> sensors_;  // those that do not see all, by BuiltSensor::id
};

}  // namespace simvis
