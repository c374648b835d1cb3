#include "python/core/measurements.h"

#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include <simvis/error.h>
#include <simvis/location.h>
#include "engine/base/srgb.h"
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
KeptImage& image_of(nb::handle self) { return nb::cast<KeptImage&>(self); }

std::string shape_text(std::initializer_list<std::size_t> shape) {
  std::string text;
  for (const std::size_t length : shape) text += (text.empty() ? "(" : ", ") + std::to_string(length);
  return text + ")";
}

// A caller's buffer: of this type and shape, writable, row by row without gaps.
template <typename T>
T* checked_out(nb::handle out, std::initializer_list<std::size_t> shape, const char* type) {
  nb::ndarray<T, nb::c_contig, nb::device::cpu> array;
  const std::string expected = std::string("expected a writable ") + type + " array of shape " + shape_text(shape) +
                               " without gaps between its numbers";
  if (!nb::try_cast(out, array, false)) throw InputError("out: " + expected);
  bool fits = array.ndim() == shape.size();
  for (std::size_t i = 0; fits && i < shape.size(); ++i) fits = array.shape(i) == shape.begin()[i];
  if (!fits) {
    std::string seen;
    for (std::size_t i = 0; i < array.ndim(); ++i) seen += (i == 0 ? "(" : ", ") + std::to_string(array.shape(i));
    throw InputError("out: the array has shape " + seen + "), " + expected);
  }
  return array.data();
}

nb::object filled(nb::object out, const float* from, std::initializer_list<std::size_t> shape) {
  std::size_t count = 1;
  for (const std::size_t length : shape) count *= length;
  std::memcpy(checked_out<float>(out, shape, "float32"), from, count * sizeof(float));
  return out;
}

nb::object channel(nb::handle self, std::string_view name) {
  const KeptScan& scan = scan_of(self);
  std::vector<std::string_view> known;
  for (const ScanChannel& each : scan.channels) {
    if (each.name == name) return view(self, each.values.data(), {scan.rings, scan.beams});
    known.push_back(each.name);
  }
  std::string all;
  for (const std::string_view each : known) all += (all.empty() ? "" : ", ") + std::string(each);
  throw InputError(
      "the scan of " + in_quotes(scan.sensor) + " has no channel " + in_quotes(name) +
      (all.empty() ? ": an effect such as intensity=\"on\" in the scene adds one" : ", expected one of " + all));
}

// What the beams of a scanner with truth="hit" meet.
nb::object labels(const KeptScan& scan) {
  const auto items = std::ranges::find(scan.channels, "true_item", &ScanChannel::name);
  if (items == scan.channels.end()) {
    throw InputError("the scan of " + in_quotes(scan.sensor) + " has no labels: truth=\"hit\" in the scene adds them");
  }
  const std::size_t count = scan.range_m.size();
  auto numbers = std::make_unique_for_overwrite<std::int32_t[]>(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double item = items->values[i];
    numbers[i] = std::isnan(item) ? -1 : static_cast<std::int32_t>(item);
  }
  return own(std::move(numbers), {scan.rings, scan.beams});
}

// As Scan::points() and Scan::world_points().
nb::object points(const KeptScan& scan, bool world, const nb::object& out) {
  const std::size_t count = scan.range_m.size();
  std::unique_ptr<double[]> memory;
  double* to = nullptr;
  if (out.is_none()) {
    memory = std::make_unique_for_overwrite<double[]>(3 * count);
    to = memory.get();
  } else {
    to = checked_out<double>(out, {count, 3}, "float64");
  }
  for (std::size_t i = 0; i < count; ++i) {
    const double range = scan.range_m[i];
    const double reach = std::isfinite(range) ? range : std::numeric_limits<double>::quiet_NaN();
    glm::dvec3 point = reach * beam_direction(scan.azimuth_rad[i % scan.beams], scan.elevation_rad[i / scan.beams]);
    if (world) point = glm::dvec3(scan.world_from_sensor * glm::dvec4(point, 1));
    for (glm::length_t axis = 0; axis < 3; ++axis) to[3 * i + static_cast<std::size_t>(axis)] = point[axis];
  }
  return out.is_none() ? own(std::move(memory), {count, 3}) : out;
}

// Colour drops alpha, which is always 1: three of four numbers, without a copy.
nb::object pixels(nb::handle self) {
  const KeptImage& image = image_of(self);
  if (image.channels == 1) return view(self, image.pixels.data(), {image.height, image.width});
  const auto width = static_cast<std::int64_t>(image.width), channels = static_cast<std::int64_t>(image.channels);
  return view(self, image.pixels.data(), {image.height, image.width, 3}, {width * channels, channels, 1});
}

void require_color(const KeptImage& image) {
  if (image.channels == 4) return;
  throw InputError("the image " + in_quotes(image.name) + " of " + in_quotes(image.sensor) +
                   " has no colour, expected one of three colours");
}

nb::object rgb(const KeptImage& image, const nb::object& out) {
  require_color(image);
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
    const nb::gil_scoped_release free;
    srgb_codes(image.pixels, {to, 3 * count});
  }
  return out.is_none() ? own(std::move(memory), {image.height, image.width, 3}) : out;
}

nb::bytes png(const KeptImage& image) {
  require_color(image);
  std::string bytes;
  {
    const nb::gil_scoped_release free;
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

nb::object ranges(nb::handle self) {
  const KeptScan& scan = scan_of(self);
  return view(self, scan.range_m.data(), {scan.rings, scan.beams});
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

void bind_measurements(nb::module_& module) {
  auto scan = nb::class_<KeptScan>(module, "Scan",
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
      "azimuth_rad",
      [](nb::handle self) { return view(self, scan_of(self).azimuth_rad.data(), {scan_of(self).beams}); },
      "(beams,) float64, radians counter-clockwise from +x about +z. A view.",
      nb::sig("def azimuth_rad(self) -> numpy.typing.NDArray[numpy.float64]"));
  scan.def_prop_ro(
      "elevation_rad",
      [](nb::handle self) { return view(self, scan_of(self).elevation_rad.data(), {scan_of(self).rings}); },
      "(rings,) float64, radians, positive upwards. A view.",
      nb::sig("def elevation_rad(self) -> numpy.typing.NDArray[numpy.float64]"));
  scan.def_prop_ro(
      "channels",
      [](const KeptScan& of) {
        std::vector<std::string> names;
        for (const ScanChannel& each : of.channels) names.push_back(each.name);
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
      [](const KeptScan& of, const std::string& frame, const nb::object& out) {
        if (frame != "sensor" && frame != "world") {
          throw InputError("frame is " + in_quotes(frame) + ", expected \"sensor\" or \"world\"");
        }
        return points(of, frame == "world", out);
      },
      "frame"_a = "sensor", "out"_a = nb::none(),
      "(rings * beams, 3) float64, metres: what the beams hit, NaN where nothing was hit. Computed with each call; "
      "`out` is filled instead of a new array.",
      nb::sig(
          "def points(self, frame: str = 'sensor', out: typing.Any = None) -> numpy.typing.NDArray[numpy.float64]"));
  scan.def(
      "read",
      [](const KeptScan& of, nb::object out) {
        return filled(std::move(out), of.range_m.data(), {of.rings, of.beams});
      },
      "out"_a, "Copies range_m to a float32 array of the caller and returns it.",
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

  auto image = nb::class_<KeptImage>(module, "Image",
                                     "One image. It keeps its frame: its array is a read-only view, and the next step "
                                     "measures into other memory.");
  image.def_prop_ro(
      "array", &pixels,
      "float32. Colour: (h, w, 3), linear radiance; depth: (h, w), metres along the optical axis, inf where "
      "nothing is hit; disparity: (h, w), pixels. Rows from the top. A view.",
      nb::sig("def array(self) -> numpy.typing.NDArray[numpy.float32]"));
  image.def("rgb", &rgb, "out"_a = nb::none(),
            "(h, w, 3) uint8, sRGB. Computed with each call; `out` is filled instead of a new array.",
            nb::sig("def rgb(self, out: typing.Any = None) -> numpy.typing.NDArray[numpy.uint8]"));
  image.def("png", &png, "The bytes of a PNG file.");
  image.def(
      "read",
      [](const KeptImage& of, nb::object out) {
        if (of.channels == 1) return filled(std::move(out), of.pixels.data(), {of.height, of.width});
        float* const to = checked_out<float>(out, {of.height, of.width, 3}, "float32");
        for (std::size_t i = 0; i < of.pixels.size() / 4; ++i)
          std::memcpy(to + 3 * i, of.pixels.data() + 4 * i, 3 * sizeof(float));
        return out;
      },
      "out"_a, "Copies `array` to a float32 array of the caller and returns it.",
      nb::sig("def read(self, out: typing.Any) -> typing.Any"));
  image.def_ro("sensor", &KeptImage::sensor, "The sensor's name.");
  image.def_ro("name", &KeptImage::name, "\"color\", \"depth\", or one of the sensor's further images.");
  image.def_ro("width", &KeptImage::width, "Pixels per row.");
  image.def_ro("height", &KeptImage::height, "Number of rows.");
  bind_exchange<&pixels>(image);
}

}  // namespace simvis::python
