// The table of boxes: how many pixels show an object, and how many would show it if it stood alone.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "tests/combinations/pixel_rays.h"

namespace simvis::combined {
namespace {

/// Pixels with a property, and those of which rounding decides whether they have it.
struct PixelCount {
  long certain = 0, doubtful = 0;

  template <class Has>
  void add(const std::array<PixelRay, 5>& rays, const Has& has) {
    const bool centre = has(rays[0]);
    const bool all_agree = std::ranges::all_of(rays, [&](const PixelRay& ray) { return has(ray) == centre; });
    (all_agree ? certain : doubtful) += centre || !all_agree ? 1 : 0;
  }
  bool allows(Real number) const { return number >= certain && number <= certain + doubtful; }
};

/// The ray of a pixel and those around it which its edges may be moved to.
std::array<PixelRay, 5> rays_of(const ViewRays& rays, int x, int y) {
  const Real share = rays.share_of_row(y), px = Real(x) + Real(0.5), py = Real(y) + Real(0.5);
  std::array<PixelRay, 5> all{rays.pixel(px, py, share)};
  const Real reach = rays.reach_px(all[0].hits.empty() ? Real(1) : all[0].hits.front().range_m);
  const Real ways[4][2] = {{1, 1}, {1, -1}, {-1, 1}, {-1, -1}};
  for (std::size_t i = 0; i < 4; ++i) {
    all[i + 1] = rays.pixel(px + reach * ways[i][0], py + reach * ways[i][1], share);
  }
  return all;
}

struct ObjectPixels {
  PixelCount visible, picture, full;
};

ObjectPixels count_pixels(const ViewRays& rays, int body) {
  const SensorDesc& desc = rays.with().desc();
  ObjectPixels pixels;
  const auto alone = [&](const PixelRay& ray) {
    std::vector<ExactHit> own = ray.hits;
    std::erase_if(own, [&](const ExactHit& hit) { return hit.body != body; });
    return ray.sees && first_of(rays.with().scene, own, rays.seen(), rays.near_m(ray.ray)).body == body;
  };
  const auto shown = [&](const PixelRay& ray) { return ray.sees && ray.hit.body == body; };
  for (int y = -desc.height_px; y < 2 * desc.height_px; ++y) {
    for (int x = -desc.width_px; x < 2 * desc.width_px; ++x) {
      const std::array<PixelRay, 5> all = rays_of(rays, x, y);
      pixels.full.add(all, alone);
      if (x < 0 || y < 0 || x >= desc.width_px || y >= desc.height_px) continue;
      pixels.picture.add(all, alone);
      pixels.visible.add(all, shown);
      if (all[0].is_doubtful) ++pixels.visible.doubtful;
    }
  }
  return pixels;
}

}  // namespace

void compare_boxes(const ViewRays& rays) {
  const Comparison& with = rays.with();
  const Measurement& table = with.measurement();
  const auto number = [&](const char* column, std::size_t row) {
    return static_cast<Real>(table.find(column)->number(row));
  };
  const std::size_t rows = table.find("object")->count();
  const bool has_views = table.find("view") != nullptr;
  for (int body = 0; body < static_cast<int>(with.scene.bodies.size()); ++body) {
    const Body& shape = with.scene.bodies[static_cast<std::size_t>(body)];
    if (!shape.has_class || shape.kind == ShapeKind::splats) continue;
    const ObjectPixels pixels = count_pixels(rays, body);
    std::size_t row = 0;
    while (row < rows && (number("object", row) != with.id("instance", body) ||
                          (has_views && number("view", row) != (rays.is_left() ? 0 : 1)))) {
      ++row;
    }
    const std::string place = "S" + std::to_string(body);
    const auto compare = [&](const char* column, const PixelCount& expected) {
      with.count("boxes");
      const Real got = row < rows ? number(column, row) : Real(0);
      if (!expected.allows(got)) with.fail("boxes", place + " " + column, got, expected.certain, expected.doubtful);
    };
    compare("picture_pixels", pixels.picture);
    compare("visible_pixels", pixels.visible);
    if (row == rows) continue;
    compare("full_pixels", pixels.full);
    const Real visible = number("visible_pixels", row), picture = number("picture_pixels", row),
               full = number("full_pixels", row);
    const auto share = [&](const char* column, Real expected) {
      with.count("shares of boxes");
      const Real got = number(column, row);
      if (std::abs(got - expected) > kDoubles)
        with.fail("shares of boxes", place + " " + column, got, expected, kDoubles);
    };
    share("visible_fraction", visible / picture);
    share("truncated", 1 - picture / full);
  }
}

}  // namespace simvis::combined
