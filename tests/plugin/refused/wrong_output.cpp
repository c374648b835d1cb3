// A sensor in a plug-in library that gives something else than its type lists, as its attribute says. A step that gives
// it to a consumer, and everything that reads it, throws InputError.
//
//     <sensor type="wrong_output" name="S" insert_at="ROOT" fault="shape"/>
#include <string>

#include <simvis/sensor.h>

namespace simvis::wrong_output {
namespace {

constexpr AttributeSpec kAttributes[] = {{.name = "fault",
                                          .kind = AttributeKind::choice,
                                          .default_value = "none",
                                          .text = "what is wrong",
                                          .choices = "none kind unit type held first stride shape empty content name "
                                                     "places columns views disparity"},
                                         kRateAttribute};

constexpr std::uint32_t kRows = 2, kColumns = 3;

std::vector<OutputSpec> outputs() {
  const OutputShape shape{kRows, kColumns, 1};
  return {{.name = "height_m", .kind = OutputKind::image, .shape = shape, .unit = "m"},
          {.name = "depth",
           .kind = OutputKind::image,
           .value_type = ValueType::f32,
           .shape = {0, 0, 1},
           .content = ImageContent::depth,
           .unit = "m"},
          {.name = "shown",
           .kind = OutputKind::image,
           .value_type = ValueType::f32,
           .shape = {kRows, kColumns, 4},
           .content = ImageContent::color},
          {.name = "parallax",
           .kind = OutputKind::image,
           .value_type = ValueType::f32,
           .shape = shape,
           .content = ImageContent::disparity,
           .unit = "px"},
          {.name = "score", .kind = OutputKind::table_column, .shape = {0, 1, 1}},
          {.name = "distance_m", .kind = OutputKind::table_column, .shape = {0, 1, 1}, .unit = "m"}};
}

// Each changes a measurement that is right.
void spoil(const std::string& fault, Measurement& measurement) {
  MeasuredArray &height = measurement.arrays[0], &depth = measurement.arrays[1], &score = measurement.arrays[3];
  const std::size_t count = height.count();
  if (fault == "kind") height.kind = OutputKind::scan_column;
  if (fault == "unit") height.unit = "mm";
  if (fault == "type") height.value_type = ValueType::f32;
  if (fault == "held") height.numbers = SharedArray<float>(std::vector<float>(count));
  if (fault == "first") height.first = 1;
  if (fault == "stride") height.stride = 2;
  if (fault == "shape") height.shape = {kColumns, kRows, 1};
  if (fault == "empty") depth = {outputs()[1], SharedArray<float>()};
  if (fault == "content") depth.content = ImageContent::color;
  if (fault == "name") height.name = "hight_m";
  if (fault == "places") score.first = 3;
  if (fault == "columns") score.shape.rows = 1;
  if (fault == "views") {
    depth.shape = {1, 1, 1};
    depth.numbers = SharedArray<float>{1.0F};
  }
  if (fault == "disparity") {
    measurement.arrays.push_back({outputs()[3], SharedArray<float>(std::vector<float>(count))});
  }
}

class WrongOutput : public Sensor {
 public:
  explicit WrongOutput(std::string fault) : fault_(std::move(fault)) {}

  void plan(const glm::dmat4& world_from_sensor, const DrawList&, FramePlan&) override {
    world_from_sensor_ = world_from_sensor;
  }

  void collect(const FrameTime& time, const FramePlan&, std::span<const PassResult>) override {
    measurement_ = {.time_ns = time.time_ns, .world_from_sensor = world_from_sensor_};
    constexpr std::size_t kCount = std::size_t{kRows} * kColumns;
    const SharedArray<double> table{1, 2, 3, 4};  // two rows of two columns
    const auto add = [&](std::size_t output, OutputShape shape, MeasuredNumbers numbers) -> MeasuredArray& {
      MeasuredArray& array = measurement_.arrays.emplace_back(MeasuredArray{outputs()[output], std::move(numbers)});
      array.shape = shape;
      return array;
    };
    add(0, {kRows, kColumns, 1}, SharedArray<double>(std::vector<double>(kCount)));
    add(1, {kRows, kColumns, 1}, SharedArray<float>(std::vector<float>(kCount, 1)));
    add(2, {kRows, kColumns, 4}, SharedArray<float>(std::vector<float>(4 * kCount, 1)));
    for (const std::size_t column : {4, 5}) {
      MeasuredArray& array = add(column, {2, 1, 1}, table);
      array.first = column - 4;
      array.stride = 2;
    }
    spoil(fault_, measurement_);
  }

  Measurement measurement() const override { return measurement_; }
  std::string method() const override { return "made up"; }

 private:
  std::string fault_;
  glm::dmat4 world_from_sensor_{1.0};
  Measurement measurement_;
};

const SensorRegistration kRegistration({
    .name = "wrong_output",
    .summary = "outputs that differ from those of its type",
    .attributes = kAttributes,
    .create = [](const SensorContext& context) -> std::unique_ptr<Sensor> {
      return std::make_unique<WrongOutput>(context.attributes.choice("fault"));
    },
    .outputs = [](const SensorContext&) { return outputs(); },
});

}  // namespace
}  // namespace simvis::wrong_output
