#include "import/sdf/sdf_lens.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <string_view>

namespace simvis {
namespace {

// The radius at an angle from the axis is theta (1 + k1 theta^2 + ... + k4 theta^8) focal lengths.
struct LensProjection {
  std::string_view name;
  std::array<double, 4> k;
  double fold_rad;  // the radius grows up to this angle
};
constexpr double kHalfTurn = std::numbers::pi;
constexpr LensProjection kProjections[] = {
    {"equidistant", {0, 0, 0, 0}, kHalfTurn},
    {"stereographic", {1.0 / 12, 1.0 / 120, 17.0 / 20160, 31.0 / 362880}, kHalfTurn},
    {"equisolid_angle", {-1.0 / 24, 1.0 / 1920, -1.0 / 322560, 1.0 / 92897280}, kHalfTurn},
    {"orthographic", {-1.0 / 6, 1.0 / 120, -1.0 / 5040, 1.0 / 362880}, kHalfTurn / 2},
};

double radius_at(const LensProjection& projection, double theta) {
  double sum = 0;
  for (auto k = projection.k.rbegin(); k != projection.k.rend(); ++k) sum = (sum + *k) * theta * theta;
  return theta * (1 + sum);
}

void add_wide_angle(const SdfElement& lens, double width_px, double height_px, double hfov_rad, SdfCommand& command,
                    ImportReport& report) {
  const std::string type = lens.child("type").text();
  if (type.empty() || type == "gnomonical") return;  // the pinhole's own projection
  const auto* const found = std::ranges::find(kProjections, std::string_view(type), &LensProjection::name);
  if (found == std::end(kProjections)) return report.leave_out("lens of type " + in_quotes(type), lens.at());
  const double fx_px = width_px / 2 / radius_at(*found, hfov_rad / 2);
  const double corner = std::hypot(width_px, height_px) / 2 / fx_px;
  constexpr double kMargin = 0.999;  // of the largest radius, beyond which a pixel has no ray
  if (hfov_rad / 2 > found->fold_rad || corner > kMargin * radius_at(*found, found->fold_rad)) {
    return report.leave_out("a lens that does not fill the picture", lens.at());
  }
  command.add("distortion", "kannala_brandt");
  constexpr const char* kNames[] = {"k1", "k2", "k3", "k4"};
  for (std::size_t i = 0; i < found->k.size(); ++i) {
    if (found->k[i] != 0) command.add(kNames[i], found->k[i]);
  }
  command.add("fx", fx_px);
}

}  // namespace

void add_sdf_lens(const SdfElement& lens, bool is_wide_angle, double width_px, double height_px, double hfov_rad,
                  SdfCommand& command, ImportReport& report) {
  if (is_wide_angle) return add_wide_angle(lens, width_px, height_px, hfov_rad, command, report);
  const SdfElement intrinsics = lens.child("intrinsics");
  if (!intrinsics) return;  // of other cameras, SDF uses nothing else
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
}

}  // namespace simvis
