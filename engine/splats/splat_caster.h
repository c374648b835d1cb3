// Rays that hit surfaces and Gaussian splats.
//
// Rule     Where the splats in front of the first surface leave at most half of the light of a ray, the ray hits the
//          splat at that half, as depths of cameras do (engine/splats/splat_rays.h). Splats of ignored items do not
//          count.
// t_min    A ray with t_min is one that continues behind a pane: it does not hit splats at or before t_min, but they
//          have stopped their share of its light.
// Hit      RayHit::item is that of the splats, RayHit::primitive the number of the splat in its cloud. surface_point()
//          gives its colour, and a normal that faces the ray: a splat has no surface.
// Bound    RayHit::error_bound_m covers the rounding of the range. It does not cover rounding that decides which splat
//          stops the half: where the light that is left differs from a half by less than about 1e-13 of itself.
// Cost     a tree for each cloud, built at its first ray and kept until a list with other clouds is cast into.
#pragma once

#include <map>
#include <memory>
#include <vector>

#include <simvis/ray_caster.h>
#include "engine/splats/splat_tree.h"

namespace simvis {

class SplatCaster : public RayCaster {
 public:
  /// Sets the list, and the caster that casts rays into its surfaces from now on. Both outlive the last cast.
  void set_world(const DrawList& list, RayCaster& surfaces);
  /// The same with the caster of the last call.
  void set_world(const DrawList& list) override;
  void ignore(std::span<const std::uint32_t> items) override;
  void cast(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> directions, std::span<RayHit> hits,
            std::span<const double> t_min_m, const HitsReady& there, HitSides sides) override;
  void cast_from(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> origins_m,
                 std::span<const glm::dvec3> directions, std::span<RayHit> hits,
                 std::span<const double> t_min_m) override;
  void parallel_for(std::size_t count, std::size_t piece, const LoopBody& body) override {
    surfaces_->parallel_for(count, piece, body);
  }
  unsigned threads() const override { return surfaces_->threads(); }
  RayCounters counters() const override { return surfaces_->counters(); }
  bool on_host() const override { return surfaces_->on_host(); }
  std::string_view engine() const override { return surfaces_->engine(); }

 private:
  // An item with splats, and its place.
  struct PlacedCloud {
    std::uint32_t item = 0;
    const SplatTree* tree = nullptr;
    glm::dmat4 mesh_from_world{1.0};
    double linear_norm = 1, condition = 1;  // of the 3x3 matrices
    double offset_m = 0;                    // from the world's origin
  };
  struct Met {
    SplatOnRay on_ray;
    const PlacedCloud* cloud = nullptr;
  };
  void place_clouds();
  void stop_rays(const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> origins_m,
                 std::span<const glm::dvec3> directions, std::span<const double> t_min_m, std::span<RayHit> hits);
  void stop(const glm::dvec3& origin_m, const glm::dvec3& way, double t_min_m, RayHit& hit, std::vector<Met>& met,
            std::vector<SplatOnRay>& found) const;
  static bool comes_before(const Met& a, const Met& b);

  RayCaster* surfaces_ = nullptr;
  const DrawList* list_ = nullptr;
  std::vector<std::uint32_t> ignored_;
  std::vector<PlacedCloud> clouds_;  // of the list without the ignored items
  bool placed_ = false;
  std::map<std::shared_ptr<const SplatCloud>, std::unique_ptr<SplatTree>> trees_;
};

}  // namespace simvis
