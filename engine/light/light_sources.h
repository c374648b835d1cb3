// Where the light of a scene comes from: lamps, surfaces that emit, and the surroundings.
//
// Lamps    lights of the draw list. The lights that are the points of one lamp with a size are one lamp here, and each
//          sample is a random point of it: see elements/lamp.h for what a point sends out. No ray hits a lamp, so that
//          only samples find its light. Points of a ball are likely by the inverse square of their distance.
// Surfaces triangles with an emission are sampled by area, and by the light that they emit. Shapes that rays meet in
//          place of triangles, and unlit surfaces, are only found by rays that hit them.
// Sky      the picture of the sky is sampled by its light, with the sum of the lights that stand for it: theirs is the
//          intensity and the tint. A sky of the same radiance everywhere is added to the ambient light.
//
// Frames   V, that of the rays.
// Density  per steradian at the point that is lit. 0: no ray that is reflected finds this light.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/frame_results.h>
#include "engine/light/sky_sampler.h"

namespace simvis {

/// Light from one direction.
struct LightSample {
  glm::dvec3 toward{0};  ///< unit length; zero: there is no light
  double distance_m = std::numeric_limits<double>::infinity();
  glm::dvec3 light{0};  ///< the radiance divided by the density; of a lamp the irradiance across `toward`
  double density = 0;
  std::uint32_t item = kNoItem, primitive = 0;  ///< the surface that emits it
};

class LightSources {
 public:
  /// Takes a list as it is seen from V. `materials` are those of its items, by DrawItem::material; lists and materials
  /// must live as long as the object is used.
  void set(const DrawList& list, const std::vector<std::shared_ptr<const Material>>& materials,
           const glm::dmat4& world_from_view);

  bool any_lamps() const { return !lamps_.empty(); }
  bool any_sky() const { return sky_share_ != glm::dvec3(0) && sky_->shines(); }
  bool any_emitters() const { return !sums_.empty() && sums_.back() > 0; }

  /// For numbers in [0, 1). There is a source of that kind.
  LightSample sample_lamps(const glm::dvec3& point_m, const glm::dvec3& random) const;
  LightSample sample_emitters(const glm::dvec3& point_m, const glm::dvec3& random) const;
  LightSample sample_sky(const glm::dvec3& random) const;

  /// Of sample_emitters() in the direction of a point of a triangle at this distance, seen by the cosine of its normal.
  double emitter_density(std::uint32_t item, double distance_m, double cosine) const;

  /// Of sample_sky() in a direction.
  double sky_density(const glm::dvec3& direction) const;

  /// The radiance that lights surfaces from a direction in which nothing is.
  glm::dvec3 arriving(const glm::dvec3& direction) const;
  /// The radiance that a camera sees in a direction in which nothing is, itself or in a mirror.
  glm::dvec3 seen(const glm::dvec3& direction) const;

 private:
  struct Lamp {
    Light light;  // with the whole intensity
    glm::dmat4 view_from_light, light_from_view;
    double radius_m;      // of a ball, else 0
    glm::dvec3 middle_m;  // V
    double power;         // luminance of the intensity
  };
  struct Emitter {
    std::uint32_t item, primitive;
    bool both_sides;
    glm::dvec3 corner_m, first_m, second_m, outward;  // V; edges from the corner, and the normal, unit length
  };
  glm::dmat4 view_from(std::uint32_t transform) const;
  void add_light(const LightItem& item);
  void add_emitters(std::uint32_t item);
  double expected(const Lamp& lamp, const glm::dvec3& point_m) const;
  const Material& material_of(std::uint32_t item) const { return *(*materials_)[list_->items[item].material]; }

  const DrawList* list_ = nullptr;
  const std::vector<std::shared_ptr<const Material>>* materials_ = nullptr;
  glm::dmat4 world_from_view_{1.0};
  glm::dmat3 sky_from_view_{1.0};
  std::shared_ptr<const SkySampler> sky_;
  glm::dvec3 sky_share_{0};  // of the picture's radiance that lights surfaces; 0: it only is seen
  glm::dvec3 ambient_{0};    // with skies of the same radiance everywhere
  std::vector<Lamp> lamps_;
  std::vector<Emitter> emitters_;
  std::vector<double> powers_;  // luminance of the emission of each item, 0 if it is not sampled
  std::vector<double> sums_;    // of luminance x area, of all emitters up to this one
};

}  // namespace simvis
