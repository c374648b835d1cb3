#include "python/core/pickling.h"

#include <nanobind/stl/string.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <simvis/error.h>
#include <simvis/location.h>
#include <simvis/version.h>
#include "python/core/measurements.h"
#include "scenegraph/array_bytes.h"
#include "sensors/output_check.h"

namespace nb = nanobind;

namespace simvis::python {
namespace {

template <typename T>
nb::bytes pack(const SharedArray<T>& numbers) {
  return nb::bytes(static_cast<const void*>(numbers.data()), numbers.size() * sizeof(T));
}

// A tuple of a crafted pickle may have any length.
nb::tuple fields_of(nb::handle packed, std::size_t count) {
  const auto fields = nb::cast<nb::tuple>(packed);
  if (fields.size() != count) throw InputError("the pickle has fields of another kind than measurements have");
  return fields;
}

// The numbers of an enumeration begin with 0; `last` is its last one.
template <typename E>
E unpack_enum(nb::handle packed, E last) {
  const int number = nb::cast<int>(packed);
  if (number < 0 || number > static_cast<int>(last)) {
    throw InputError("the pickle has a kind of output with the number " + std::to_string(number) + ", expected 0 to " +
                     std::to_string(static_cast<int>(last)));
  }
  return static_cast<E>(number);
}

template <typename T>
SharedArray<T> unpack(nb::handle packed) {
  const auto bytes = nb::cast<nb::bytes>(packed);
  std::vector<T> numbers(bytes.size() / sizeof(T));
  if (!numbers.empty()) std::memcpy(numbers.data(), bytes.c_str(), numbers.size() * sizeof(T));
  return numbers;
}

nb::bytes pack(const glm::dmat4& matrix) { return nb::bytes(static_cast<const void*>(&matrix), sizeof matrix); }

glm::dmat4 unpack_matrix(nb::handle packed) {
  const auto bytes = nb::cast<nb::bytes>(packed);
  glm::dmat4 matrix;
  if (bytes.size() != sizeof matrix) throw InputError("the pickled pose is no matrix");
  std::memcpy(&matrix, bytes.c_str(), sizeof matrix);
  return matrix;
}

template <typename E>
int code(E value) {
  return static_cast<int>(value);
}

nb::tuple pack(const MeasuredArray& array) {
  const std::vector<std::uint8_t> numbers = own_bytes(array);
  return nb::make_tuple(array.name, code(array.kind), code(array.value_type), array.shape.rows, array.shape.columns,
                        array.shape.channels, array.unit, array.numbers.index(),
                        nb::bytes(numbers.data(), numbers.size()), code(array.content), array.view, array.format,
                        array.bound);
}

template <std::size_t kIndex = 0>
MeasuredNumbers unpack_numbers(std::size_t index, nb::handle packed) {
  if constexpr (kIndex == std::variant_size_v<MeasuredNumbers>) {
    throw InputError("the pickled numbers are of a type that there is not");
  } else {
    using Array = std::variant_alternative_t<kIndex, MeasuredNumbers>;
    using Number = std::remove_cvref_t<decltype(std::declval<const Array&>()[0])>;
    return index == kIndex ? MeasuredNumbers(unpack<Number>(packed)) : unpack_numbers<kIndex + 1>(index, packed);
  }
}

MeasuredArray unpack_array(nb::handle packed) {
  constexpr std::size_t kFields = 13;
  const nb::tuple of = fields_of(packed, kFields);
  MeasuredArray array;
  array.name = nb::cast<std::string>(of[0]);
  array.kind = unpack_enum(of[1], OutputKind::scalar);
  array.value_type = unpack_enum(of[2], ValueType::f64);
  array.shape.rows = nb::cast<std::uint32_t>(of[3]);
  array.shape.columns = nb::cast<std::uint32_t>(of[4]);
  array.shape.channels = nb::cast<std::uint32_t>(of[5]);
  array.unit = nb::cast<std::string>(of[6]);
  array.numbers = unpack_numbers(nb::cast<std::size_t>(of[7]), of[8]);
  array.content = unpack_enum(of[9], ImageContent::counts);
  array.view = nb::cast<std::string>(of[10]);
  array.format = nb::cast<std::string>(of[11]);
  array.bound = nb::cast<std::string>(of[12]);
  std::string wrong = output_difference(array, array);
  if (wrong.empty() && array.kind != OutputKind::table_column && array.count() == 0) wrong = "no numbers";
  if (!wrong.empty()) throw InputError("the pickled array " + in_quotes(array.name) + ": " + wrong);
  return array;
}

nb::tuple state(const KeptImage& image) { return nb::make_tuple(std::string(version()), image.sensor, pack(image)); }

void fill(KeptImage& image, const nb::tuple& of) {
  image.sensor = nb::cast<std::string>(of[1]);
  static_cast<MeasuredArray&>(image) = unpack_array(of[2]);
}

template <typename Kept>
nb::tuple state(const Kept& measurement) {
  nb::list arrays, numbers;
  for (const MeasuredArray& each : measurement.arrays) arrays.append(pack(each));
  for (const NumberOnRequest& each : measurement.on_request) {
    numbers.append(nb::make_tuple(each.name, each.unit, each.compute()));
  }
  return nb::make_tuple(std::string(version()), measurement.sensor, measurement.time_ns,
                        pack(measurement.world_from_sensor), arrays, numbers);
}

void fill(KeptMeasurement& measurement, const nb::tuple& of) {
  measurement.sensor = nb::cast<std::string>(of[1]);
  measurement.time_ns = nb::cast<std::int64_t>(of[2]);
  measurement.world_from_sensor = unpack_matrix(of[3]);
  for (const nb::handle each : nb::cast<nb::list>(of[4])) measurement.arrays.push_back(unpack_array(each));
  for (const nb::handle each : nb::cast<nb::list>(of[5])) {
    const nb::tuple number = fields_of(each, 3);
    const double value = nb::cast<double>(number[2]);
    measurement.on_request.push_back(
        {nb::cast<std::string>(number[0]), nb::cast<std::string>(number[1]), [value] { return value; }});
  }
}

/// A scan is a measurement whose arrays fit together, since views of them are made without a check.
void fill(KeptScan& scan, const nb::tuple& of) {
  KeptMeasurement measurement;
  fill(measurement, of);
  std::optional<Scan> made = to_scan(std::move(measurement));
  if (!made) throw InputError("the pickled scan has arrays that do not fit together");
  static_cast<Scan&>(scan) = *std::move(made);
  scan.sensor = nb::cast<std::string>(of[1]);
}

/// Numbers of the tuple of a type.
template <typename Kept>
constexpr std::size_t kFields = std::is_same_v<Kept, KeptImage> ? 3 : 6;

template <typename Kept>
void bind(nb::handle type) {
  auto bound = nb::borrow<nb::class_<Kept>>(type);
  bound.def(
      "__getstate__", [](const Kept& self) { return state(self); }, "What pickle keeps of it.",
      nb::sig("def __getstate__(self) -> tuple[typing.Any, ...]"));
  bound.def(
      "__setstate__",
      [](Kept& self, const nb::tuple& of) {
        if (of.size() != kFields<Kept> || !nb::isinstance<nb::str>(of[0]) ||
            nb::cast<std::string>(of[0]) != version()) {
          throw InputError("the pickle is no measurement, or of another version of SimVis, expected " +
                           std::string(version()));
        }
        Kept made;
        try {
          fill(made, of);
        } catch (const nb::cast_error&) {
          throw InputError("the pickle is no measurement of SimVis");
        }
        new (&self) Kept(std::move(made));
      },
      "Fills it with what pickle kept.", nb::sig("def __setstate__(self, of: tuple[typing.Any, ...], /) -> None"));
}

}  // namespace

void bind_pickling(nb::module_& module) {
  bind<KeptScan>(module.attr("Scan"));
  bind<KeptImage>(module.attr("Image"));
  bind<KeptMeasurement>(module.attr("Measurement"));
}

}  // namespace simvis::python
