// Radiance along rays by random paths, whose mean is exact for the light that is reflected up to `bounces` times.
//
// Path     A ray is followed from surface to surface. Each surface adds what it emits, and light of one lamp, of one
//          random point of the surfaces that emit and of one random direction of the sky, if nothing blocks it
//          (light_sources.h). The path then goes on in one random direction, as the surface reflects
//          (surface_reflection.h).
// Weights  Light that both a random point and a random direction can find is weighted by both densities, the balance
//          heuristic of Veach and Guibas, "Optimally Combining Sampling Techniques" (1995).
// Straight A surface that covers less than all of what lies behind, and a pane of glass, lets paths and light pass
//          straight on. A mirror reflects in one direction. What it reflects is seen as by the camera.
// Fog      Each stretch between two surfaces, or between a surface and a lamp, is attenuated and adds airlight. Lamps
//          without a place and the surroundings are taken as what arrives at surfaces.
// Sides    Rays of the camera pass the backs of single-sided surfaces, all others hit both sides.
// Not      Lamps are not seen in mirrors, and light is not bent in solid glass.
// Numbers  A path's random numbers depend on the sample, the frame, the pixel and the number of draws before.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/philox.h>
#include <simvis/ray_caster.h>
#include "engine/light/light_sources.h"
#include "engine/light/lit_surface.h"

namespace simvis {

/// A scene at one moment.
struct PathScene {
  const DrawList* list = nullptr;  ///< the world of the caster, where everything is hit that covers anything
  /// By DrawItem::material: those that the list has, or had before everything was made to be hit.
  const std::vector<std::shared_ptr<const Material>>* materials = nullptr;
  RayCaster* caster = nullptr;
  glm::dmat4 world_from_view{1.0};  ///< V, rigid; rays start at its origin
};

/// A ray from the origin of V.
struct PathStart {
  std::uint32_t pixel = 0;
  glm::dvec3 direction{0};  ///< V, unit length
  double near_m = 0;        ///< what is nearer is not seen
  std::uint32_t draws = 0;  ///< random numbers of the pixel that others have taken: the path takes those behind them
};

class PathTracer {
 public:
  explicit PathTracer(std::uint32_t bounces) : bounces_(bounces) {}

  /// The scene of the next traces; what it points to must live until the last of them.
  void set(const PathScene& scene);
  /// Sets radiance[i] to that of one path from starts[i], linear RGB. Equal for any number of threads.
  void trace(std::span<const PathStart> starts, const SensorRandom& random, std::uint64_t frame,
             std::span<glm::dvec3> radiance);

 private:
  struct Path {
    std::uint32_t start = 0, pixel = 0;  // index of the start
    std::uint32_t draws = 0, bounces = 0;
    bool from_camera = true;  // no surface has turned it
    bool seen = true;         // only mirrors have turned it
    double density = 0;       // of its direction; 0: no random point finds what it finds
    glm::dvec3 origin_m{0}, direction{0}, share{1};
    double behind_m = 0;  // hits up to there are passed
    double in_air_m = 0;  // up to there the air has been taken into account
  };
  /// Light that arrives unless something blocks it.
  struct LightRay {
    std::uint32_t start = 0;
    glm::dvec3 origin_m{0}, light{0};
    double behind_m = 0;
    LightSample sample{};
  };
  static constexpr std::size_t kKinds = 3;  // of light sources
  using LightRays = std::array<LightRay, kKinds>;
  // Uniform numbers in [0, 1): the last chooses among sources, whose shares may be below 2^-32, the step of one number.
  struct Numbers {
    const SensorRandom& random;
    std::uint64_t frame;
    double one(Path& path) const { return random.uniform(frame, path.pixel, path.draws++); }
    static double choice(double first, double second) { return std::min(first + 0x1p-32 * second, 1 - 0x1p-53); }
    glm::dvec3 three(Path& path) const {
      const std::array<double, 4> numbers = random.uniforms(frame, path.pixel, path.draws++);
      return {numbers[0], numbers[1], choice(numbers[2], numbers[3])};
    }
  };

  void cast_paths();
  /// Returns whether the path goes on. `added` is what the start gets without light rays.
  bool follow(Path& path, const RayHit& hit, const Numbers& numbers, LightRays& lights, glm::dvec3& added) const;
  bool meet(Path& path, const RayHit& hit, const LitSurface& surface, const Numbers& numbers, LightRays& lights) const;
  bool reflect(Path& path, const RayHit& hit, const LitSurface& surface, const Numbers& numbers,
               LightRays& lights) const;
  glm::dvec3 escaped(const Path& path) const;
  double emission_weight(const Path& path, const RayHit& hit, const LitSurface& surface) const;
  void cast_lights(std::span<glm::dvec3> radiance);
  bool passes(LightRay& ray, const RayHit& hit) const;
  const Material& material_of(std::uint32_t item) const {
    return *(*scene_.materials)[scene_.list->items[item].material];
  }
  double transmittance(double distance_m) const;

  std::uint32_t bounces_;
  PathScene scene_;
  LightSources sources_;
  std::vector<Path> paths_;
  std::vector<RayHit> hits_;
  std::vector<LightRays> lights_;      // by path
  std::vector<LightRay> light_rays_;   // on their way
  std::vector<glm::dvec3> added_;      // by path
  std::vector<std::uint8_t> goes_on_;  // by path or by light ray
  std::vector<glm::dvec3> origins_m_, directions_;
  std::vector<double> behind_m_;
};

}  // namespace simvis
