#include "sensors/beam_tables/matrix_table.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <string>

#include <simvis/location.h>
#include "engine/base/input_file.h"

namespace simvis {
namespace {

constexpr std::size_t kMatrixBytes = 12 * sizeof(float);

// The third column of a rotation in float32, whose matrix was multiplied out, has its length within a few roundings of
// 2^-24; files that were turned by hand are farther off.
constexpr double kUnitLength = 1e-3;

using MatrixRows = std::array<double, 12>;

MatrixRows matrix_at(const Bytes& bytes, std::size_t number) {
  MatrixRows rows{};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::uint32_t word = 0;
    for (std::size_t byte = 0; byte < 4; ++byte) {
      word |= std::uint32_t{bytes[number * kMatrixBytes + 4 * i + byte]} << (8 * byte);
    }
    rows[i] = static_cast<double>(std::bit_cast<float>(word));
  }
  return rows;
}

TableBeam beam_of(const MatrixRows& rows, const std::string& file, std::size_t number) {
  const auto fail = [&](const char* what) { fail_at({.file = file}, "matrix " + std::to_string(number) + " " + what); };
  if (!std::ranges::all_of(rows, [](double value) { return std::isfinite(value); })) {
    fail("has a number that is not finite, expected finite numbers");
  }
  const glm::dvec3 direction(rows[2], rows[6], rows[10]), origin_m(rows[3], rows[7], rows[11]);
  if (std::abs(glm::length(direction) - 1) > kUnitLength) {
    fail("has a third column that is no unit vector, expected the direction of the beam");
  }
  if (std::max({std::abs(origin_m.x), std::abs(origin_m.y), std::abs(origin_m.z)}) > kMaxBeamOrigin_m) {
    fail("has a beam that starts more than 10 m from the sensor, expected at most that");
  }
  return {.azimuth_deg = glm::degrees(std::atan2(direction.y, direction.x)),
          .elevation_deg = glm::degrees(std::atan2(direction.z, std::hypot(direction.x, direction.y))),
          .origin_m = origin_m};
}

}  // namespace

BeamTable read_matrix_table(const std::filesystem::path& file) {
  const InputFile input(file);
  const std::size_t count = input.size() / kMatrixBytes;
  if (count == 0 || input.size() % kMatrixBytes != 0 || count > kMaxTableBeams) {
    fail_at({.file = file.string()}, "has " + std::to_string(input.size()) +
                                         " bytes, expected 48 for each beam, and from 1 to " +
                                         std::to_string(kMaxTableBeams) + " beams");
  }
  const Bytes bytes = input.read(0, count * kMatrixBytes);
  std::vector<TableBeam> beams;
  beams.reserve(count);
  for (std::size_t i = 0; i < count; ++i) beams.push_back(beam_of(matrix_at(bytes, i), file.string(), i));
  return make_beam_table(beams);
}

}  // namespace simvis
