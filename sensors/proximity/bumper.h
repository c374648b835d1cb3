// The sensor `bumper`: a switch that closes while a part of the robot overlaps with the rest of the world.
//
//   <sensor type="bumper" name="BUMP_FRONT" insert_at="BUMPER" ignore="ROBOT"/>
//
// Test     The switch is closed while any triangle of the items at `part` crosses a triangle of the other items that do
//          not stand at `ignore`: their surfaces have a point in common that is inside an edge of one and the face of
//          the other. All triangles are tested, in double, in the frame of the sensor, less those whose boxes are
//          apart; lines and points never count. No physics is needed.
// Limits   Surfaces that only touch do not count, nor does a bumper that lies wholly inside a closed body: steps must
//          be shorter than the bumper is deep. Touching faces in one plane do not cross.
// Values   pressed: 1 or 0. x_m, y_m, z_m: the mean of the points where edges meet faces, in the sensor frame; no value
//          while the switch is open. crossings: their number. own_instance, other_instance: the ids of the objects
//          with the most crossings, of the bumper and of the rest, as cameras show them; 0 while the switch is open.
#pragma once

#include <string>
#include <vector>

#include <simvis/reading_sensor.h>
#include "sensors/described_sensor.h"

namespace simvis {

struct BumperDesc {
  std::string part = "ROOT", ignore = "ROOT";  ///< insertion points

  static AttributeRows<BumperDesc> rows();
  /// Its part by default is that of insert_at. Throws InputError if that is ROOT.
  void complete(const SensorContext& context);
};

class Bumper : public ReadingSensor {
 public:
  explicit Bumper(BumperDesc desc);

  SensorNeeds needs() const override { return {.parts = {desc_.part, desc_.ignore}, .item_ids = true}; }
  void sense(const SensedWorld& world) override;
  void plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) override;
  void collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) override;
  std::string method() const override { return "crossing triangles"; }

 private:
  BumperDesc desc_;
  ItemRange part_, ignored_;        // of this frame
  ItemIds ids_;                     // of this frame
  const DrawList* list_ = nullptr;  // of this frame
};

}  // namespace simvis
