// A sensor in a plug-in library: the distance to the surface on the x axis of its frame.
//
//     <sensor type="distance_probe" name="PROBE" insert_at="ROBOT"/>
//
// Output  NAME.csv with the column distance_m: metres along x, inf where nothing is hit.
#include <iterator>
#include <limits>

#include <simvis/pose.h>
#include <simvis/reading_sensor.h>

namespace simvis {
namespace {

constexpr AttributeSpec kAttributes[] = {
    {.name = "near",
     .default_value = "0.01",
     .unit = "m",
     .text = "what is nearer is not seen",
     .min = 0,
     .open_min = true},
    kRateAttribute,
};

const TableColumn kColumns[] = {{.name = "distance_m",
                                 .format = "%.9g",
                                 .unit = "m",
                                 .meaning = "along x",
                                 .frame = "sensor",
                                 .nothing = std::numeric_limits<double>::infinity(),
                                 .in_message = false}};

/// One pixel of depth, whose centre is the x axis.
class DistanceProbe : public ReadingSensor {
 public:
  explicit DistanceProbe(const SensorContext& context)
      : ReadingSensor({std::begin(kColumns), std::end(kColumns)}),
        name_(context.name),
        near_m_(context.attributes.number("near")) {}

  void plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) override {
    ReadingSensor::plan(world_from_sensor, list, plan);
    View view;
    view.name = name_;
    view.reason = "distance probe " + name_;
    view.pinhole = {.fx_px = 1, .fy_px = 1, .cx_px = 0.5, .cy_px = 0.5};
    view.near_m = near_m_;
    view.view_from_world = rigid_inverse(sensor_from_view()) * rigid_inverse(world_from_sensor);
    view.width_px = view.height_px = 1;
    pass_ = plan.passes.size();
    plan.passes.push_back({.name = name_, .width_px = 1, .height_px = 1, .depth = true, .views = {view}});
  }

  void collect(const FrameTime& time, const FramePlan&, std::span<const PassResult> results) override {
    const double depth = results[pass_].depth[0];
    set_reading(time, {depth > 0 ? near_m_ / depth : std::numeric_limits<double>::infinity()});
  }

  std::string method() const override { return "one pixel of depth"; }

 private:
  std::string name_;
  double near_m_;
  std::size_t pass_ = 0;
};

const SensorRegistration kRegistration({
    .name = "distance_probe",
    .summary = "the distance to whatever lies on the x axis of its frame",
    .attributes = kAttributes,
    .create = [](const SensorContext& context) -> std::unique_ptr<Sensor> {
      return std::make_unique<DistanceProbe>(context);
    },
    .outputs = [](const SensorContext&) { return column_outputs(kColumns, OutputKind::scalar); },
});

}  // namespace
}  // namespace simvis
