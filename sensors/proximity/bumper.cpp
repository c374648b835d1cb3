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
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <simvis/pose.h>
#include <simvis/reading_sensor.h>
#include "sensors/described_sensor.h"
#include "sensors/proximity/crossing_triangles.h"

namespace simvis {
namespace {

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

const std::vector<TableColumn> kBumperColumns{
    {.name = "pressed", .format = "%lld", .integer = true, .meaning = "1: pressed; 0: not"},
    {.name = "x_m",
     .format = "%.9g",
     .unit = "m",
     .meaning = "mean place of the crossings, x",
     .frame = "sensor",
     .nothing = std::numeric_limits<double>::quiet_NaN()},
    {.name = "y_m",
     .format = "%.9g",
     .unit = "m",
     .meaning = "mean place of the crossings, y",
     .frame = "sensor",
     .nothing = std::numeric_limits<double>::quiet_NaN()},
    {.name = "z_m",
     .format = "%.9g",
     .unit = "m",
     .meaning = "mean place of the crossings, z",
     .frame = "sensor",
     .nothing = std::numeric_limits<double>::quiet_NaN()},
    {.name = "crossings", .format = "%lld", .integer = true, .meaning = "number of pairs of triangles that cross"},
    {.name = "own_instance",
     .format = "%lld",
     .integer = true,
     .meaning = "id of the object of the bumper with the most crossings, as in objects.csv; 0: not pressed"},
    {.name = "other_instance",
     .format = "%lld",
     .integer = true,
     .meaning = "id of the object that crosses it most, as in objects.csv; 0: not pressed"}};

const SensorRegistration kBumperRegistration(
    {.name = "bumper",
     .summary = "A switch that closes while a part of the robot overlaps with the rest of the world.",
     .notes = "The surfaces of the part and of the rest cross; sensors/proximity/bumper.cpp says how this is tested. A "
              "bumper that lies wholly inside another body is not pressed.",
     .attributes = rows_of<BumperDesc>().table(),
     .create = [](const SensorContext& context) -> std::unique_ptr<Sensor> {
       return std::make_unique<Bumper>(read_desc<BumperDesc>(context));
     },
     .outputs = column_outputs_of<kBumperColumns>});

}  // namespace

AttributeRows<BumperDesc> BumperDesc::rows() {
  return {row(&BumperDesc::part, AttributeKind::object, "part",
              "the part that senses, with everything inserted there; default: that of insert_at"),
          row(&BumperDesc::ignore, AttributeKind::object, "ignore",
              "a part that may overlap with it, with everything inserted there, mostly the robot; default: part"),
          kRateAttribute};
}

void BumperDesc::complete(const SensorContext& context) {
  const AttributeValues& a = context.attributes;
  if (!a.is_set("part")) part = context.insertion_point();
  if (!a.is_set("ignore")) ignore = part;
  if (part != "ROOT") return;
  fail_at(a.where("part"),
          "a bumper at ROOT would be the whole world, expected the attribute \"part\" or another insert_at");
}

Bumper::Bumper(BumperDesc desc) : ReadingSensor(kBumperColumns), desc_(std::move(desc)) {}

void Bumper::sense(const SensedWorld& world) {
  part_ = world.items_of(desc_.part);
  ignored_ = world.items_of(desc_.ignore);
  ids_ = world.item_ids();
}

void Bumper::plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) {
  ReadingSensor::plan(world_from_sensor, list, plan);
  list_ = &list;
}

void Bumper::collect(const FrameTime& time, const FramePlan&, std::span<const PassResult>) {
  const glm::dmat4 sensor_from_world = rigid_inverse(world_from_sensor());
  Crossings crossings;
  std::vector<TriangleSet> own;
  std::vector<std::uint32_t> own_items;
  TriangleBox reach;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint64_t> pairs;  // crossings of two objects
  const auto is_hidden = [this](std::uint32_t item) { return !list_->items[item].visible; };
  for (std::uint32_t i = part_.first; i < part_.end; ++i) {
    if (is_hidden(i)) continue;
    own.push_back(triangles_of(*list_, i, sensor_from_world));
    own_items.push_back(i);
    reach.add(own.back().box);
  }
  const auto is_in = [](ItemRange range, std::uint32_t item) { return item >= range.first && item < range.end; };
  for (std::uint32_t i = 0; i < list_->items.size(); ++i) {
    if (is_hidden(i) || is_in(part_, i) || is_in(ignored_, i)) continue;
    if (!item_box(*list_, i, sensor_from_world).overlaps(reach)) continue;
    const TriangleSet other = triangles_of(*list_, i, sensor_from_world, &reach);
    for (std::size_t mine = 0; mine < own.size(); ++mine) {
      const std::uint64_t before = crossings.count;
      add_crossings(own[mine], other, crossings);
      if (crossings.count > before) {
        pairs[{ids_.instance[own_items[mine]], ids_.instance[i]}] += crossings.count - before;
      }
    }
  }
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const bool pressed = crossings.count > 0;
  const glm::dvec3 mean = pressed ? crossings.sum_m / static_cast<double>(crossings.count) : glm::dvec3(kNone);
  std::pair<std::uint32_t, std::uint32_t> most{0, 0};
  std::uint64_t most_count = 0;
  for (const auto& [objects, count] : pairs) {
    if (count > most_count) {
      most = objects;
      most_count = count;
    }
  }
  set_reading(time, {pressed ? 1.0 : 0.0, mean.x, mean.y, mean.z, static_cast<double>(crossings.count),
                     static_cast<double>(most.first), static_cast<double>(most.second)});
}

}  // namespace simvis
