#include "simvis/sharing/output_message.h"

#include <algorithm>
#include <cstring>
#include <glm/gtc/type_ptr.hpp>
#include <iterator>
#include <string_view>
#include <utility>
#include <variant>

#include <simvis/size_product.h>
#include "scenegraph/array_bytes.h"

namespace simvis {
namespace {

template <std::size_t kIndex = 0>
std::optional<MeasuredNumbers> numbers_of(std::size_t index, std::size_t count,
                                          const std::vector<std::uint8_t>& bytes) {
  if constexpr (kIndex < std::variant_size_v<MeasuredNumbers>) {
    if (index != kIndex) return numbers_of<kIndex + 1>(index, count, bytes);
    using Array = std::variant_alternative_t<kIndex, MeasuredNumbers>;
    using Number = std::remove_cvref_t<decltype(std::declval<Array>().front())>;
    if (bytes.size() % sizeof(Number) != 0 || bytes.size() / sizeof(Number) != count) return std::nullopt;
    std::vector<Number> numbers(count);
    if (count > 0) std::memcpy(numbers.data(), bytes.data(), bytes.size());
    return MeasuredNumbers(Array(std::move(numbers)));
  }
  return std::nullopt;
}

}  // namespace

ros::Output to_message(const MeasuredArray& array) {
  return {.name = array.name,
          .kind = std::string(to_string(array.kind)),
          .unit = array.unit,
          .rows = array.shape.rows,
          .columns = array.shape.columns,
          .channels = array.shape.channels,
          .type = std::string(to_string(array.held_type())),
          .data = own_bytes(array)};
}

std::optional<MeasuredArray> to_array(ros::Output message) {
  constexpr OutputKind kKinds[] = {OutputKind::image, OutputKind::scan_column, OutputKind::table_column,
                                   OutputKind::scalar};
  const auto named = [](const auto& text) { return [&text](const auto& value) { return to_string(value) == text; }; };
  const auto kind = std::ranges::find_if(kKinds, named(message.kind));
  const auto type = std::ranges::find_if(kHeldTypes, named(message.type));
  if (kind == std::end(kKinds) || type == std::end(kHeldTypes)) return std::nullopt;
  if (message.channels == 0) return std::nullopt;
  std::optional<MeasuredNumbers> numbers =
      numbers_of(static_cast<std::size_t>(type - std::begin(kHeldTypes)),
                 size_product({message.rows, message.columns, message.channels}), message.data);
  if (!numbers) return std::nullopt;
  return MeasuredArray{{.name = std::move(message.name),
                        .kind = *kind,
                        .value_type = *type,
                        .shape = {message.rows, message.columns, message.channels},
                        .unit = std::move(message.unit)},
                       *std::move(numbers)};
}

std::optional<Measurement> to_measurement(ros::HostMeasurement message) {
  constexpr std::size_t kMaxOutputs = 1024;  // more than any sensor has
  if (message.outputs.size() > kMaxOutputs) return std::nullopt;
  Measurement measurement{.time_ns = message.time_ns,
                          .world_from_sensor = glm::make_mat4(message.world_from_sensor.data())};
  for (ros::Output& output : message.outputs) {
    std::optional<MeasuredArray> array = to_array(std::move(output));
    if (!array) return std::nullopt;
    measurement.arrays.push_back(*std::move(array));
  }
  return measurement;
}

}  // namespace simvis
