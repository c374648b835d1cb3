#include "python/core/measurements.h"

#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <type_traits>
#include <variant>

#include <simvis/depth_points.h>
#include <simvis/error.h>
#include <simvis/location.h>
#include <simvis/size_product.h>
#include "engine/base/srgb.h"
#include "python/core/free_work.h"
#include "scenegraph/pictures/png_file.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace simvis::python {
namespace {

template <typename T>
using ReadOnly = nb::ndarray<nb::numpy, const T>;

// A view whose base is the measurement, so that it lives as long as the array.
template <typename T>
nb::object view(nb::handle owner, const T* data, std::initializer_list<std::size_t> shape,
                std::initializer_list<std::int64_t> strides = {}) {
  return nb::cast(ReadOnly<T>(data, shape, owner, strides), nb::rv_policy::reference);
}

template <typename T>
nb::object own(std::unique_ptr<T[]> data, std::initializer_list<std::size_t> shape) {
  T* const numbers = data.release();
  const nb::capsule owner(numbers, [](void* memory) noexcept { delete[] static_cast<T*>(memory); });
  return nb::cast(nb::ndarray<nb::numpy, T>(numbers, shape, owner), nb::rv_policy::reference);
}

KeptScan& scan_of(nb::handle self) { return nb::cast<KeptScan&>(self); }

// The shape by which NumPy has an array: that of an image without the dimension of a single channel, one number of a
// table for each row.
std::vector<std::size_t> shape_of(const MeasuredArray& array) {
  const OutputShape& shape = array.shape;
  if (array.kind == OutputKind::table_column) return {shape.rows};
  if (shape.channels == 1) return {shape.rows, shape.columns};
  return {shape.rows, shape.columns, shape.channels};
}

// Red, green and blue of a colour image without its alpha, which is always 1: a copy without gaps, which cannot be
// written, as views of the other arrays.
template <typename Number>
nb::object colors_of(const MeasuredArray& array, const SharedArray<Number>& numbers) {
  constexpr std::size_t kChannels = 3;
  const std::size_t pixels = size_product({array.shape.rows, array.shape.columns});
  const std::size_t stride = array.shape.channels * array.stride;
  auto colors = std::make_unique_for_overwrite<Number[]>(size_product({pixels, kChannels}));
  {
    const FreeWork free;
    for (std::size_t i = 0; i < pixels; ++i) {
      std::copy_n(numbers.data() + array.first + i * stride, kChannels, &colors[i * kChannels]);
    }
  }
  const nb::capsule owner(colors.get(), [](void* memory) noexcept { delete[] static_cast<Number*>(memory); });
  return view(owner, colors.release(), {array.shape.rows, array.shape.columns, kChannels});
}

// A view whose base is the measurement; of colour a copy.
nb::object array_of(nb::handle owner, const MeasuredArray& array) {
  const std::vector<std::size_t> shape = shape_of(array);
  std::vector<std::int64_t> strides(shape.size());
  auto step = static_cast<std::int64_t>(array.stride);
  for (std::size_t i = shape.size(); i-- > 0; step *= static_cast<std::int64_t>(shape[i])) strides[i] = step;
  return std::visit(
      [&]<typename Number>(const SharedArray<Number>& numbers) {
        if (array.content == ImageContent::color) return colors_of(array, numbers);
        static constexpr Number kNone{};  // NumPy takes an array without an address for one that can be written
        const Number* const data = numbers.empty() ? &kNone : numbers.data() + array.first;
        return nb::cast(ReadOnly<Number>(data, shape.size(), shape.data(), owner, strides.data()),
                        nb::rv_policy::reference);
      },
      array.numbers);
}

// A single number as a float, any other output as an array.
nb::object output_of(nb::handle self, const std::string& name) {
  const auto& measurement = nb::cast<const KeptMeasurement&>(self);
  if (const MeasuredArray* const array = measurement.find(name)) {
    return array->kind == OutputKind::scalar ? nb::float_(array->number(0)) : array_of(self, *array);
  }
  if (const std::optional<double> value = measurement.value(name)) return nb::float_(*value);
  throw nb::key_error(name.c_str());
}

std::vector<std::string> output_names(const KeptMeasurement& measurement) {
  std::vector<std::string> names;
  for (const MeasuredArray& each : measurement.arrays) names.push_back(each.name);
  for (const NumberOnRequest& each : measurement.on_request) names.push_back(each.name);
  return names;
}

nb::dict output_units(const KeptMeasurement& measurement) {
  nb::dict units;
  for (const MeasuredArray& each : measurement.arrays) units[each.name.c_str()] = each.unit;
  for (const NumberOnRequest& each : measurement.on_request) units[each.name.c_str()] = each.unit;
  return units;
}

std::string shape_text(std::span<const std::size_t> shape) {
  std::string text;
  for (const std::size_t length : shape) text += (text.empty() ? "(" : ", ") + std::to_string(length);
  return text + ")";
}

// A caller's buffer: of this type and shape, writable, row by row without gaps.
template <typename T>
T* checked_out(nb::handle out, const std::vector<std::size_t>& shape, const char* type) {
  nb::ndarray<T, nb::c_contig, nb::device::cpu> array;
  const std::string expected = std::string("expected a writable ") + type + " array of shape " + shape_text(shape) +
                               " without gaps between its numbers";
  if (!nb::try_cast(out, array, false)) throw InputError("out: " + expected);
  bool fits = array.ndim() == shape.size();
  for (std::size_t i = 0; fits && i < shape.size(); ++i) fits = array.shape(i) == shape[i];
  if (!fits) {
    std::string seen;
    for (std::size_t i = 0; i < array.ndim(); ++i) seen += (i == 0 ? "(" : ", ") + std::to_string(array.shape(i));
    throw InputError("out: the array has shape " + seen + "), " + expected);
  }
  return array.data();
}

nb::object channel(nb::handle self, std::string_view name) {
  const KeptScan& scan = scan_of(self);
  std::string all;
  for (const MeasuredArray& each : scan.channels()) {
    if (each.name == name) return array_of(self, each);
    all += (all.empty() ? "" : ", ") + each.name;
  }
  throw InputError(
      "the scan of " + in_quotes(scan.sensor) + " has no channel " + in_quotes(name) +
      (all.empty() ? ": an effect such as intensity=\"on\" in the scene adds one" : ", expected one of " + all));
}

// What the beams of a scanner with truth="hit" meet.
nb::object labels(const KeptScan& scan) {
  const SharedNumbers<double> items = scan.channel("true_item");
  if (items.empty()) {
    throw InputError("the scan of " + in_quotes(scan.sensor) + " has no labels: truth=\"hit\" in the scene adds them");
  }
  const std::size_t count = scan.range_m.size();
  auto numbers = std::make_unique_for_overwrite<std::int32_t[]>(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double item = items[i];
    numbers[i] = std::isnan(item) ? -1 : static_cast<std::int32_t>(item);
  }
  return own(std::move(numbers), {scan.rings, scan.beams});
}

// As Scan::points() and Scan::world_points(); `point` gives each in the sensor's frame.
template <typename PointOf>
nb::object point_array(std::size_t count, const PointOf& point_of, const glm::dmat4& world_from_sensor,
                       const std::string& frame, const nb::object& out) {
  if (frame != "sensor" && frame != "world") {
    throw InputError("frame is " + in_quotes(frame) + ", expected \"sensor\" or \"world\"");
  }
  std::unique_ptr<double[]> memory;
  double* to = nullptr;
  if (out.is_none()) {
    memory = std::make_unique_for_overwrite<double[]>(3 * count);
    to = memory.get();
  } else {
    to = checked_out<double>(out, {count, 3}, "float64");
  }
  for (std::size_t i = 0; i < count; ++i) {
    glm::dvec3 point = point_of(i);
    if (frame == "world") point = glm::dvec3(world_from_sensor * glm::dvec4(point, 1));
    for (glm::length_t axis = 0; axis < 3; ++axis) to[3 * i + static_cast<std::size_t>(axis)] = point[axis];
  }
  return out.is_none() ? own(std::move(memory), {count, 3}) : out;
}

nb::object pixels(nb::handle self) { return array_of(self, nb::cast<const KeptImage&>(self)); }

template <typename Number>
constexpr const char* type_name() {
  if constexpr (std::is_same_v<Number, float>) return "float32";
  if constexpr (std::is_same_v<Number, std::uint8_t>) return "uint8";
  if constexpr (std::is_same_v<Number, std::uint32_t>) return "uint32";
  if constexpr (std::is_same_v<Number, std::int32_t>) return "int32";
  return "float64";
}

// Copies what array_of() shows to an array of the caller.
nb::object read(const MeasuredArray& array, nb::object out) {
  std::vector<std::size_t> shape = shape_of(array);
  const std::size_t channels = array.shape.channels;
  const std::size_t shown = array.content == ImageContent::color ? 3 : channels;
  if (shown != channels) shape.back() = shown;
  std::visit(
      [&]<typename Number>(const SharedArray<Number>& numbers) {
        Number* to = checked_out<Number>(out, shape, type_name<Number>());
        for (std::size_t i = 0; i < array.count(); i += channels) to = std::copy_n(numbers.data() + i, shown, to);
      },
      array.numbers);
  return out;
}

nb::object read_ranges(const KeptScan& scan, nb::object out) {
  std::ranges::copy(scan.range_m, checked_out<float>(out, {scan.rings, scan.beams}, type_name<float>()));
  return out;
}

Image color_of(const KeptImage& image) {
  if (image.content == ImageContent::color) return *to_image(image);
  throw InputError("the image " + in_quotes(image.name) + " of " + in_quotes(image.sensor) +
                   " has no colour, expected one of three colours");
}

nb::object rgb(const KeptImage& kept, const nb::object& out) {
  const Image image = color_of(kept);
  const std::size_t count = std::size_t{image.width} * image.height;
  std::unique_ptr<std::uint8_t[]> memory;
  std::uint8_t* to = nullptr;
  if (out.is_none()) {
    memory = std::make_unique_for_overwrite<std::uint8_t[]>(3 * count);
    to = memory.get();
  } else {
    to = checked_out<std::uint8_t>(out, {image.height, image.width, 3}, "uint8");
  }
  {
    const FreeWork free;
    srgb_codes(image.pixels, {to, 3 * count});
  }
  return out.is_none() ? own(std::move(memory), {image.height, image.width, 3}) : out;
}

nb::bytes png(const KeptImage& kept) {
  const Image image = color_of(kept);
  std::string bytes;
  {
    const FreeWork free;
    bytes = encode_png(image);
  }
  return nb::bytes(bytes.data(), bytes.size());
}

nb::object numpy_array(nb::object array, const nb::object& dtype, const nb::object& copy) {
  if (!dtype.is_none()) array = array.attr("astype")(dtype, "copy"_a = false);
  return !copy.is_none() && nb::cast<bool>(copy) ? array.attr("copy")() : array;
}

// A consumer of DLPack before 1.0 takes all memory for writable. It gets a copy, unless it forbids one and is refused.
nb::object exchanged(nb::object array, const nb::kwargs& how) {
  const nb::object version = how.contains("max_version") ? nb::object(how["max_version"]) : nb::none();
  const bool knows_read_only = !version.is_none() && nb::cast<int>(version[0]) >= 1;
  const bool may_copy = !how.contains("copy") || how["copy"].is_none() || nb::cast<bool>(how["copy"]);
  if (!knows_read_only && may_copy) array = array.attr("copy")();
  return array.attr("__dlpack__")(**how);
}

// Adds the methods by which NumPy and consumers of DLPack read an object as an array.
template <nb::object (*Get)(nb::handle)>
void bind_exchange(auto& bound) {
  bound.def(
      "__array__",
      [](nb::handle self, const nb::object& dtype, const nb::object& copy) {
        return numpy_array(Get(self), dtype, copy);
      },
      "dtype"_a = nb::none(), "copy"_a = nb::none());
  bound.def(
      "__dlpack__", [](nb::handle self, const nb::kwargs& how) { return exchanged(Get(self), how); },
      nb::sig("def __dlpack__(self, **how: typing.Any) -> typing.Any"));
  bound.def(
      "__dlpack_device__", [](nb::handle) { return nb::make_tuple(1, 0); },
      nb::sig("def __dlpack_device__(self) -> tuple[int, int]"));
}

// By beam or by ring, or with a beam table by both.
nb::object angles(nb::handle self, const SharedNumbers<double>& angles_rad, std::size_t count) {
  const KeptScan& scan = scan_of(self);
  if (angles_rad.size() == count) return view(self, angles_rad.data(), {count});
  return view(self, angles_rad.data(), {scan.rings, scan.beams});
}

nb::object ranges(nb::handle self) {
  const KeptScan& scan = scan_of(self);
  return view(self, scan.range_m.data(), {scan.rings, scan.beams});
}

void bind_image(nb::module_& module) {
  auto image = BoundClass<KeptImage>(module, "Image",
                                     "One image. It keeps its frame: its array is a read-only view, and the next step "
                                     "measures into other memory.");
  image.def_prop_ro("array", &pixels,
                    "(h, w), or (h, w, channels) if there are several, rows from the top, of the type and in the unit "
                    "of the output. Colour: (h, w, 3) float32, linear radiance. A view.",
                    nb::sig("def array(self) -> numpy.typing.NDArray[typing.Any]"));
  image.def("rgb", &rgb, "out"_a = nb::none(),
            "(h, w, 3) uint8, sRGB. Computed with each call; `out` is filled instead of a new array.",
            nb::sig("def rgb(self, out: typing.Any = None) -> numpy.typing.NDArray[numpy.uint8]"));
  image.def("png", &png, "The bytes of a PNG file.");
  image.def(
      "read", [](const KeptImage& of, nb::object out) { return read(of, std::move(out)); }, "out"_a,
      "Copies `array` to an array of the caller, of the same type and shape, and returns it.",
      nb::sig("def read(self, out: typing.Any) -> typing.Any"));
  image.def_ro("sensor", &KeptImage::sensor, "The sensor's name.");
  image.def_ro("name", &KeptImage::name, "The name of the output.");
  image.def_ro("unit", &KeptImage::unit, "The unit of its numbers; \"\": none.");
  image.def_prop_ro(
      "width", [](const KeptImage& of) { return of.shape.columns; }, "Pixels per row.");
  image.def_prop_ro(
      "height", [](const KeptImage& of) { return of.shape.rows; }, "Number of rows.");
  bind_exchange<&pixels>(image);
}

void bind_measurement(nb::module_& module) {
  auto measurement =
      BoundClass<KeptMeasurement>(module, "Measurement",
                                  "All outputs of one measurement, by name. It keeps its frame: its arrays are "
                                  "read-only views, and the next step measures into other memory.");
  measurement.def("__getitem__", &output_of, "name"_a,
                  "A single number as a float, an image as (h, w) or (h, w, channels), a column of a scan as (rings, "
                  "beams), (1, beams) or (rings, 1), a column of a table as (rows,). A view.",
                  nb::sig("def __getitem__(self, name: str) -> typing.Any"));
  measurement.def("keys", &output_names, "The names of the outputs, as docs/reference.md lists them.");
  measurement.def("_ipython_key_completions_", &output_names, "What IPython offers behind a bracket.");
  measurement.def_prop_ro("units", &output_units, "The unit of each output; \"\": none.",
                          nb::sig("def units(self) -> dict[str, str]"));
  measurement.def_prop_ro(
      "pose", [](const KeptMeasurement& of) { return to_array(of.world_from_sensor); },
      "(4, 4) float64: world_from_sensor at the time of the measurement.",
      nb::sig("def pose(self) -> numpy.typing.NDArray[numpy.float64]"));
  measurement.def_ro("time_ns", &KeptMeasurement::time_ns, "Simulated time of the measurement, nanoseconds.");
  measurement.def_ro("sensor", &KeptMeasurement::sensor, "The sensor's name.");
}

}  // namespace

nb::object to_array(const glm::dmat4& matrix) {
  auto rows = std::make_unique<double[]>(16);
  for (glm::length_t row = 0; row < 4; ++row) {
    for (glm::length_t column = 0; column < 4; ++column) {
      rows[static_cast<std::size_t>(4 * row + column)] = matrix[column][row];
    }
  }
  return own(std::move(rows), {4, 4});
}

nb::object to_array(std::span<const double> numbers, std::size_t rows, std::size_t columns) {
  auto copy = std::make_unique<double[]>(numbers.size());
  std::ranges::copy(numbers, copy.get());
  return own(std::move(copy), {rows, columns});
}

nb::object points_of(const KeptScan& scan, const std::string& frame, const nb::object& out) {
  return point_array(
      scan.range_m.size(), [&](std::size_t i) { return scan.point(i); }, scan.world_from_sensor, frame, out);
}

nb::object points_of(const KeptMeasurement& camera, const std::string& frame, const nb::object& out) {
  const auto depth = std::ranges::find(camera.arrays, ImageContent::depth, &MeasuredArray::content);
  if (depth == camera.arrays.end()) {
    throw InputError(in_quotes(camera.sensor) + " has no points, since its outputs have no depth");
  }
  const auto points = depth_points(camera, depth->view);
  if (!points) {
    throw InputError("the lens of " + in_quotes(camera.sensor) + " is not known, so its pixels have no points");
  }
  return point_array(
      points->size(), [&](std::size_t i) { return (*points)[i]; }, camera.world_from_sensor, frame, out);
}

void bind_measurements(nb::module_& module) {
  auto scan = BoundClass<KeptScan>(module, "Scan",
                                   "One sweep of a laser scanner. It keeps its frame: its arrays are read-only views, "
                                   "and the next step measures into other memory.");
  scan.def_prop_ro("range_m", &ranges,
                   "(rings, beams) float32, metres along the ray; inf: nothing hit, 0: nearer than range_min. A view.",
                   nb::sig("def range_m(self) -> numpy.typing.NDArray[numpy.float32]"));
  scan.def_prop_ro(
      "error_bound_m",
      [](nb::handle self) {
        const KeptScan& of = scan_of(self);
        return view(self, of.error_bound_m.data(), {of.rings, of.beams});
      },
      "(rings, beams) float32, metres: the true range lies within range_m +- error_bound_m. A view.",
      nb::sig("def error_bound_m(self) -> numpy.typing.NDArray[numpy.float32]"));
  scan.def_prop_ro(
      "azimuth_rad", [](nb::handle self) { return angles(self, scan_of(self).azimuth_rad, scan_of(self).beams); },
      "(beams,) float64, radians counter-clockwise from +x about +z; (rings, beams) with a pattern. A view.",
      nb::sig("def azimuth_rad(self) -> numpy.typing.NDArray[numpy.float64]"));
  scan.def_prop_ro(
      "elevation_rad", [](nb::handle self) { return angles(self, scan_of(self).elevation_rad, scan_of(self).rings); },
      "(rings,) float64, radians, positive upwards; (rings, beams) with a pattern. A view.",
      nb::sig("def elevation_rad(self) -> numpy.typing.NDArray[numpy.float64]"));
  scan.def_prop_ro(
      "channels",
      [](const KeptScan& of) {
        std::vector<std::string> names;
        for (const MeasuredArray& each : of.channels()) names.push_back(each.name);
        return names;
      },
      "Names of the further numbers per beam, which effects add.");
  scan.def("channel", &channel, "name"_a,
           "(rings, beams) float64: further numbers per beam, such as \"intensity\". A view.",
           nb::sig("def channel(self, name: str) -> numpy.typing.NDArray[numpy.float64]"));
  scan.def_prop_ro(
      "intensity", [](nb::handle self) { return channel(self, "intensity"); },
      "(rings, beams) float64, 1/m^2: the channel of that name. A view.",
      nb::sig("def intensity(self) -> numpy.typing.NDArray[numpy.float64]"));
  scan.def_prop_ro("labels", &labels,
                   "(rings, beams) int32 of a scanner with truth=\"hit\": what each beam meets, as a place in "
                   "sim.items; -1: nothing. "
                   "Computed with each call.",
                   nb::sig("def labels(self) -> numpy.typing.NDArray[numpy.int32]"));
  scan.def(
      "points",
      [](const KeptScan& of, const std::string& frame, const nb::object& out) { return points_of(of, frame, out); },
      "frame"_a = "sensor", "out"_a = nb::none(),
      "(rings * beams, 3) float64, metres: what the beams hit, NaN where nothing was hit. Computed with each call; "
      "`out` is filled instead of a new array.",
      nb::sig(
          "def points(self, frame: str = 'sensor', out: typing.Any = None) -> numpy.typing.NDArray[numpy.float64]"));
  scan.def("read", &read_ranges, "out"_a, "Copies range_m to a float32 array of the caller and returns it.",
           nb::sig("def read(self, out: typing.Any) -> typing.Any"));
  scan.def_prop_ro(
      "pose", [](const KeptScan& of) { return to_array(of.world_from_sensor); },
      "(4, 4) float64: world_from_sensor at the time of the scan.",
      nb::sig("def pose(self) -> numpy.typing.NDArray[numpy.float64]"));
  scan.def_prop_ro(
      "time_s", [](const KeptScan& of) { return static_cast<double>(of.time_ns) / 1e9; },
      "Simulated time of the measurement, seconds.");
  scan.def_ro("time_ns", &KeptScan::time_ns, "Simulated time of the measurement, nanoseconds.");
  scan.def_ro("sensor", &KeptScan::sensor, "The sensor's name.");
  scan.def_ro("rings", &KeptScan::rings, "Number of rings.");
  scan.def_ro("beams", &KeptScan::beams, "Beams per ring.");
  bind_exchange<&ranges>(scan);

  bind_image(module);
  bind_measurement(module);
}

}  // namespace simvis::python
