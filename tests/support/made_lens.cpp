#include "tests/support/made_lens.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <numbers>

#include <simvis/attributes.h>

namespace simvis::test {
namespace {

using Real = long double;
using Real2 = std::array<Real, 2>;

// Brown and Conrady, and OpenCV's model of 8, 12 or 14 coefficients, as its documentation writes it.
Real2 perspective(const std::vector<double>& given, Real x, Real y) {
  std::vector<Real> c(14, 0);
  std::ranges::copy(given, c.begin());
  const Real r2 = x * x + y * y, r4 = r2 * r2, r6 = r4 * r2;
  const Real s = (1 + c[0] * r2 + c[1] * r4 + c[4] * r6) / (1 + c[5] * r2 + c[6] * r4 + c[7] * r6);
  const Real xd = x * s + 2 * c[2] * x * y + c[3] * (r2 + 2 * x * x) + c[8] * r2 + c[9] * r4;
  const Real yd = y * s + c[2] * (r2 + 2 * y * y) + 2 * c[3] * x * y + c[10] * r2 + c[11] * r4;
  const Real cx = std::cos(c[12]), sx = std::sin(c[12]), cy = std::cos(c[13]), sy = std::sin(c[13]);
  // R = Ry Rx, row by row.
  const Real r[3][3] = {{cy, sx * sy, -sy * cx}, {0, cx, sx}, {sy, -cy * sx, cy * cx}};
  Real w[3];
  for (int i = 0; i < 3; ++i) w[i] = r[i][0] * xd + r[i][1] * yd + r[i][2];
  return {(r[2][2] * w[0] - r[0][2] * w[2]) / w[2], (r[2][2] * w[1] - r[1][2] * w[2]) / w[2]};
}

Real polynomial(const std::vector<double>& c, Real x) {
  Real sum = 0, power = 1;
  for (const double each : c) {
    sum += each * power;
    power *= x;
  }
  return sum;
}

// The radius in focal lengths.
Real fisheye_radius(const MadeLens& lens, Real theta) {
  const std::vector<double>& c = lens.coefficients;
  if (lens.model == "kannala_brandt") {
    const Real t2 = theta * theta;
    return theta * (1 + t2 * (c[0] + t2 * (c[1] + t2 * (c[2] + t2 * c[3]))));
  }
  if (lens.model == "ftheta") return polynomial(c, theta) / lens.pinhole.fx_px;
  if (lens.model == "ftheta_backward") {
    // Bisection: angles grow up to 3000 px.
    Real low = 0, high = 3000;
    for (int i = 0; i < 80; ++i) (polynomial(c, (low + high) / 2) < theta ? low : high) = (low + high) / 2;
    return low / lens.pinhole.fx_px;
  }
  REQUIRE(lens.model == "double_sphere");
  const Real xi = c[0], alpha = c[1], sine = std::sin(theta), cosine = std::cos(theta);
  const Real d2 = std::sqrt(sine * sine + (xi + cosine) * (xi + cosine));
  return sine / (alpha * d2 + (1 - alpha) * (xi + cosine));
}

}  // namespace

const LensType& lens_type(const MadeLens& lens) {
  const auto found = std::ranges::find(lens_types(), lens.model, &LensType::name);
  REQUIRE(found != lens_types().end());
  return **found;
}

Lens made(const MadeLens& lens) {
  const std::optional<Lens> found = lens_of(lens.pinhole, lens_type(lens).ros_name, lens.coefficients);
  REQUIRE(found);
  return *found;
}

std::string lens_attributes(const MadeLens& lens) {
  std::string text = "distortion=\"" + std::string(lens.model) + '"';
  const AttributeTable rows = lens_type(lens).coefficients;
  if (rows[0].kind == AttributeKind::text) {
    text += " " + std::string(rows[0].name) + "=\"";
    for (const double each : lens.coefficients) text += " " + format_number(each);
    return text + '"';
  }
  for (std::size_t i = 0; i < lens.coefficients.size(); ++i) {
    const double to_degrees = rows[i].unit == "deg" ? 180 / std::numbers::pi : 1;
    text += " " + std::string(rows[i].name) + "=\"" + format_number(to_degrees * lens.coefficients[i]) + '"';
  }
  return text;
}

glm::dvec2 formula_pixel(const MadeLens& lens, const glm::dvec3& point) {
  const Real x = point.x, y = point.y, z = point.z;
  Real2 place;
  if (lens.model == "brown_conrady" || lens.model == "rational_polynomial") {
    place = perspective(lens.coefficients, x / z, y / z);
  } else {
    const Real across = std::sqrt(x * x + y * y);
    if (across == 0) return {lens.pinhole.cx_px, lens.pinhole.cy_px};
    const Real radius = fisheye_radius(lens, std::atan2(across, z));
    place = {radius * x / across, radius * y / across};
  }
  return {static_cast<double>(lens.pinhole.fx_px * place[0] + lens.pinhole.cx_px),
          static_cast<double>(lens.pinhole.fy_px * place[1] + lens.pinhole.cy_px)};
}

}  // namespace simvis::test
