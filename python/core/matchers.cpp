#include "python/core/matchers.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include <simvis/testing.h>
#include "python/core/arguments.h"
#include "python/core/measurements.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace simvis::python {
namespace {

template <typename Number, typename Shape>
using Numbers = nb::ndarray<const Number, Shape, nb::c_contig, nb::device::cpu>;
using Points = Numbers<double, nb::shape<-1, 3>>;
using Pixels = Numbers<std::uint8_t, nb::shape<-1, -1, 3>>;

// Whether it holds, the text, and the number of the beam that the text names, or None.
using Answer = std::tuple<bool, std::string, std::optional<std::size_t>>;

Answer answer(const test_kit::Verdict& verdict) {
  std::optional<std::size_t> beam;
  if (verdict.beam.ranges != nullptr) beam = verdict.beam.index;
  return {verdict.ok, verdict.text, beam};
}

glm::dvec3 to_point(const double* coordinates) { return {coordinates[0], coordinates[1], coordinates[2]}; }

Answer near_path(const Points& point, const Points& path, double distance_m) {
  std::vector<glm::dvec3> points;
  for (std::size_t i = 0; i < path.shape(0); ++i) points.push_back(to_point(path.data() + 3 * i));
  return answer(test_kit::near_path(to_point(point.data()), points, distance_m));
}

template <typename Array>
auto span_of(const Array& array) {
  return std::span(array.data(), array.size());
}

test_kit::ColorCodes to_codes(const Pixels& pixels) {
  return {static_cast<std::uint32_t>(pixels.shape(1)), static_cast<std::uint32_t>(pixels.shape(0)), span_of(pixels)};
}

}  // namespace

void bind_matchers(nb::module_& module) {
  module.def(
      "range_near",
      [](const KeptScan& scan, std::size_t beam, double expected_m, double slack_m) {
        return answer(test_kit::range_near(scan, beam, expected_m, slack_m));
      },
      "scan"_a, "beam"_a, "expected_m"_a, "slack_m"_a);
  module.def(
      "scans_near",
      [](const KeptScan& one, const KeptScan& other, double slack_m) {
        return answer(test_kit::scans_near(one, other, slack_m));
      },
      "one"_a, "other"_a, "slack_m"_a);
  module.def(
      "clear_of", [](const KeptScan& scan, double distance_m) { return answer(test_kit::clear_of(scan, distance_m)); },
      "scan"_a, "distance_m"_a);
  module.def(
      "pose_near",
      [](const Matrix& one, const Matrix& other, double position_m, double angle_deg) {
        return answer(test_kit::pose_near(to_matrix(one), to_matrix(other), position_m, angle_deg));
      },
      "one"_a, "other"_a, "position_m"_a, "angle_deg"_a);
  module.def("near_path", &near_path, "point"_a, "path"_a, "distance_m"_a);
  module.def(
      "depths_near",
      [](const Numbers<float, nb::ndim<2>>& one, const Numbers<double, nb::ndim<2>>& other, double allowed_m) {
        return answer(test_kit::detail::compare_depths(one.shape(1), span_of(one), span_of(other), allowed_m));
      },
      "one"_a, "other"_a, "allowed_m"_a);
  module.def(
      "pictures_near",
      [](const Pixels& one, const Pixels& other, int codes, double share, nb::handle difference) {
        const std::string file = difference.is_none() ? std::string() : path_of("difference", difference);
        return answer(test_kit::pictures_near(to_codes(one), to_codes(other), codes, share, file));
      },
      "one"_a, "other"_a, "codes"_a, "share"_a, "difference"_a.none());
}

}  // namespace simvis::python
