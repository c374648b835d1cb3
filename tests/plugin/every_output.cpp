// A sensor in a plug-in library with made-up outputs of each form and type of number. Nothing else names them: files,
// messages, shared memory, pages and Python have them because its type lists them and measurement() gives them. A test
// of all consumers includes this file.
//
//     <sensor type="every_output" name="S" insert_at="ROBOT"/>
#include <numeric>

#include <simvis/sensor.h>

namespace simvis::every_output {
namespace {

constexpr AttributeSpec kAttributes[] = {kRateAttribute};

constexpr std::uint32_t kRows = 3, kColumns = 4, kTableRows = 2;

OutputSpec image(std::string name, ValueType type, std::uint32_t channels, std::string unit) {
  return {.name = std::move(name),
          .kind = OutputKind::image,
          .value_type = type,
          .shape = {kRows, kColumns, channels},
          .unit = std::move(unit),
          .meaning = "made up"};
}

OutputSpec column(std::string name, std::string unit) {
  return {.name = std::move(name),
          .kind = OutputKind::table_column,
          .shape = {0, 1, 1},
          .unit = std::move(unit),
          .meaning = "made up"};
}

std::vector<OutputSpec> outputs() {
  return {image("instance", ValueType::u32, 1, ""),
          image("code", ValueType::u8, 1, ""),
          image("offset_mm", ValueType::i32, 2, "mm"),
          image("normal", ValueType::f32, 3, ""),
          image("height_m", ValueType::f64, 1, "m"),
          column("score", ""),
          column("distance_m", "m")};
}

template <typename Number>
SharedArray<Number> counted(std::size_t count, Number first) {
  std::vector<Number> numbers(count);
  std::iota(numbers.begin(), numbers.end(), first);
  return numbers;
}

class EveryOutput : public Sensor {
 public:
  void plan(const glm::dmat4& world_from_sensor, const DrawList&, FramePlan&) override {
    world_from_sensor_ = world_from_sensor;
  }

  void collect(const FrameTime& time, const FramePlan&, std::span<const PassResult>) override {
    measurement_ = {.time_ns = time.time_ns, .world_from_sensor = world_from_sensor_};
    for (const OutputSpec& spec : outputs()) {
      const bool is_image = spec.kind == OutputKind::image;
      const OutputShape shape = is_image ? spec.shape : OutputShape{kTableRows, 1, 1};
      measurement_.arrays.push_back({spec, numbers(spec.value_type, shape, static_cast<std::uint8_t>(time.index))});
      measurement_.arrays.back().shape = shape;
    }
  }

  Measurement measurement() const override { return measurement_; }
  std::string method() const override { return "made up"; }

 private:
  // Whole numbers that float32 does not hold, and thirds that no decimals hold.
  static MeasuredNumbers numbers(ValueType type, const OutputShape& shape, std::uint8_t frame) {
    const std::size_t count = std::size_t{shape.rows} * shape.columns * shape.channels;
    if (type == ValueType::u32) return counted<std::uint32_t>(count, 4'000'000'001U + frame);
    if (type == ValueType::u8) return counted<std::uint8_t>(count, frame);
    if (type == ValueType::i32) return counted<std::int32_t>(count, -2'000'000'001 + frame);
    if (type == ValueType::f32) return counted<float>(count, static_cast<float>(frame) / 3);
    return counted<double>(count, frame / 3.0);
  }

  glm::dmat4 world_from_sensor_{1.0};
  Measurement measurement_;
};

const SensorRegistration kRegistration({
    .name = "every_output",
    .summary = "made-up outputs of each form",
    .attributes = kAttributes,
    .create = [](const SensorContext&) -> std::unique_ptr<Sensor> { return std::make_unique<EveryOutput>(); },
    .outputs = [](const SensorContext&) { return outputs(); },
});

}  // namespace
}  // namespace simvis::every_output
