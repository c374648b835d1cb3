#include "import/sdf/sdf_lens.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <span>
#include <string_view>

namespace simvis {
namespace {

struct LensAttribute {
  const char* name;
  double value;
};

// 2 sin(theta / 2) to theta^9, as theta (1 + k1 theta^2 + ... + k4 theta^8).
constexpr LensAttribute kEquisolid[] = {
    {"k1", -1.0 / 24}, {"k2", 1.0 / 1920}, {"k3", -1.0 / 322560}, {"k4", 1.0 / 92897280}};
// A sphere whose pinhole is on it, and one whose pinhole is far behind it.
constexpr LensAttribute kStereographic[] = {{"alpha", 0.5}}, kOrthographic[] = {{"alpha", 1}};

double equisolid_radius(double theta) {
  double sum = 0;
  for (std::size_t i = std::size(kEquisolid); i-- > 0;) sum = (sum + kEquisolid[i].value) * theta * theta;
  return theta * (1 + sum);
}

struct LensProjection {
  std::string_view name;
  const char* distortion;
  std::span<const LensAttribute> attributes;
  double (*radius)(double theta);  // at an angle from the axis, in focal lengths
  double fold_rad;                 // the radius grows up to this angle
};
constexpr double kHalfTurn = std::numbers::pi;
constexpr LensProjection kProjections[] = {
    {"equidistant", "kannala_brandt", {}, [](double theta) { return theta; }, kHalfTurn},
    {"stereographic", "double_sphere", kStereographic, [](double theta) { return 2 * std::tan(theta / 2); }, kHalfTurn},
    {"equisolid_angle", "kannala_brandt", kEquisolid, equisolid_radius, kHalfTurn},
    {"orthographic", "double_sphere", kOrthographic, [](double theta) { return std::sin(theta); }, kHalfTurn / 2},
};

bool add_wide_angle(const SdfElement& lens, double width_px, double height_px, double hfov_rad, SdfCommand& command,
                    ImportReport& report) {
  const std::string type = lens.child("type").text();
  if (type.empty() || type == "gnomonical") return false;  // the pinhole's own projection
  const auto* const found = std::ranges::find(kProjections, std::string_view(type), &LensProjection::name);
  if (found == std::end(kProjections)) {
    report.leave_out("lens of type " + in_quotes(type), lens.at());
    return false;
  }
  const double fx_px = width_px / 2 / found->radius(hfov_rad / 2);
  const double corner = std::hypot(width_px, height_px) / 2 / fx_px;
  constexpr double kMargin = 0.999;  // of the largest radius, beyond which a pixel has no ray
  if (hfov_rad / 2 > found->fold_rad || corner > kMargin * found->radius(found->fold_rad)) {
    report.leave_out("a lens that does not fill the picture", lens.at());
    return false;
  }
  command.add("distortion", found->distortion);
  for (const LensAttribute& each : found->attributes) command.add(each.name, each.value);
  command.add("fx", fx_px);
  return true;
}

}  // namespace

bool add_sdf_lens(const SdfElement& lens, bool is_wide_angle, double width_px, double height_px, double hfov_rad,
                  SdfCommand& command, ImportReport& report) {
  if (is_wide_angle) return add_wide_angle(lens, width_px, height_px, hfov_rad, command, report);
  const SdfElement intrinsics = lens.child("intrinsics");
  if (!intrinsics) return false;  // of other cameras, SDF uses nothing else
  const double fx = intrinsics.child("fx").number(0), fy = intrinsics.child("fy").number(fx);
  if (!(fx > 0 && fy > 0 && std::isfinite(fx) && std::isfinite(fy))) {
    intrinsics.fail("has focal lengths <fx> and <fy> that are not above 0");
  }
  if (intrinsics.child("s").number(0) != 0) report.leave_out("skew <s> of a camera", intrinsics.at());
  command.add("fx", fx);
  command.add("fy", fy);
  // SDF counts from the corner of the picture, and the camera from the centre of the first pixel.
  const double cx = intrinsics.child("cx").number(width_px / 2), cy = intrinsics.child("cy").number(height_px / 2);
  if (!(std::isfinite(cx) && std::isfinite(cy))) intrinsics.fail("has a principal point that is not finite");
  command.add("cx", cx - 0.5);
  command.add("cy", cy - 0.5);
  return true;
}

}  // namespace simvis
