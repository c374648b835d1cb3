// The reflection of surfaces against quadratures of the microfacet model in another form.
#include "engine/light/surface_reflection.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <simvis/philox.h>
#include "tests/light/path_stage.h"

TEST_SUITE_BEGIN("engine/light");

namespace simvis::test {
namespace {

constexpr int kGrid = 400;            // points of a quadrature along each axis
constexpr double kQuadrature = 2e-5;  // midpoints of kGrid^2 cells, compared with 7.5 times as many along each axis

// Smith's Lambda of Trowbridge-Reitz: Heitz (2014), equation 72.
double lambda(double alpha, double cosine) {
  const double tan2 = 1 / (cosine * cosine) - 1;
  return (std::sqrt(1 + alpha * alpha * tan2) - 1) / 2;
}

double schlick(double normal, double cosine) { return normal + (1 - normal) * std::pow(1 - cosine, 5); }

// The share of light from all around that goes to an eye at this cosine: over the microfacets, whose projected area is
// distributed evenly over u = 1 / (1 + tan^2 / alpha^2) and the azimuth, and over the directions of the layer below,
// which are even in u and the azimuth. The grid is denser where u is small, since facets are far from the normal there.
double quadrature_albedo(double base, double roughness, double metallic, double eye_cosine) {
  const double alpha = roughness * roughness, normal = 0.04 + (base - 0.04) * metallic;
  const glm::dvec3 eye(std::sqrt(1 - eye_cosine * eye_cosine), 0, eye_cosine);
  double sum = 0;
  for (int i = 0; i < kGrid; ++i) {
    for (int j = 0; j < kGrid; ++j) {
      const double root = (i + 0.5) / kGrid, u = root * root * root, width = 3 * root * root;
      const double angle = 2 * kPi * (j + 0.5) / kGrid;
      const double tangent = alpha * std::sqrt((1 - u) / u), cosine = 1 / std::sqrt(1 + tangent * tangent);
      const glm::dvec3 facet(cosine * tangent * std::cos(angle), cosine * tangent * std::sin(angle), cosine);
      const double facing = glm::dot(eye, facet), light = 2 * facing * facet.z - eye.z;
      if (facing > 0 && light > 0) {
        const double seen = 1 / (1 + lambda(alpha, eye_cosine) + lambda(alpha, light));
        sum += width * schlick(normal, facing) * seen * facing / (eye_cosine * facet.z);
      }
      const double across = std::sqrt(u), up = std::sqrt(1 - u);
      const glm::dvec3 below(across * std::cos(angle), across * std::sin(angle), up);
      const double half = std::sqrt(std::max(0.0, (1 + glm::dot(below, eye)) / 2));
      sum += width * (1 - schlick(normal, half)) * base * (1 - metallic);
    }
  }
  return sum / (kGrid * kGrid);
}

TEST_CASE("the density of sampled directions is that which is stated, and they give the albedo of the model") {
  constexpr std::uint32_t kSamples = 20000;
  const SensorRandom random(1, "directions");
  std::uint64_t scene = 0;
  for (const double roughness : {0.05, 0.2, 0.5, 0.9}) {
    for (const double metallic : {0.0, 0.5, 1.0}) {
      for (const double eye_cosine : {0.15, 0.6, 0.98}) {
        CAPTURE(roughness);
        CAPTURE(metallic);
        CAPTURE(eye_cosine);
        const SurfaceReflection surface{
            .normal = {0, 0, 1}, .base = glm::dvec3(0.7), .roughness = roughness, .metallic = metallic, .matte = false};
        const glm::dvec3 eye(std::sqrt(1 - eye_cosine * eye_cosine), 0, eye_cosine);
        double sum = 0, squares = 0;
        ++scene;
        for (std::uint32_t i = 0; i < kSamples; ++i) {
          const glm::dvec3 direction = sample_direction(
              surface, eye, {random.uniform(scene, i, 0), random.uniform(scene, i, 1), random.uniform(scene, i, 2)});
          const double share = reflected_share(surface, eye, direction).x;
          const double value = share == 0 ? 0 : share / direction_density(surface, eye, direction);
          sum += value;
          squares += value * value;
        }
        const double mean = sum / kSamples, variance = std::max(0.0, squares / kSamples - mean * mean);
        CHECK(agree(mean, quadrature_albedo(0.7, roughness, metallic, eye_cosine), std::sqrt(variance / kSamples),
                    kQuadrature));
      }
    }
  }
}

TEST_CASE("the reflection is reciprocal, and a matte surface has no highlight") {
  const glm::dvec3 a = glm::normalize(glm::dvec3(0.3, 0.2, 0.7)), b = glm::normalize(glm::dvec3(-0.5, 0.4, 0.4));
  for (const bool matte : {true, false}) {
    const SurfaceReflection surface{
        .normal = {0, 0, 1}, .base = {0.2, 0.5, 0.8}, .roughness = 0.4, .metallic = matte ? 0.0 : 0.3, .matte = matte};
    const glm::dvec3 there = reflected_share(surface, a, b) / b.z, back = reflected_share(surface, b, a) / a.z;
    for (int c = 0; c < 3; ++c) CHECK(std::abs(there[c] - back[c]) <= 1e-15 + 1e-14 * there[c]);
    if (matte) CHECK(there == surface.base / kPi * (b.z / b.z));
    CHECK(reflected_share(surface, a, {0, 0.6, -0.8}) == glm::dvec3(0));
  }
}

}  // namespace
}  // namespace simvis::test
