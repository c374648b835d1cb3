#include "import/programs/clouds/splat_columns.h"

#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include <simvis/location.h>

namespace simvis {
namespace {

std::uint32_t degree_of(const SplatColumns& columns) {
  for (std::uint32_t degree = 0; degree <= kMaxHarmonicsDegree; ++degree) {
    if (columns.harmonics.size() == 3 * harmonics_count(degree)) return degree;
  }
  fail_at({.file = columns.file.string()},
          "has " + std::to_string(columns.harmonics.size() - 3) +
              " properties \"f_rest_...\", expected 0, 9, 24 or 45: all spherical harmonics of degree 0, 1, 2 or 3");
}

// A coefficient of the three channels.
glm::vec3 harmonic(const SplatColumns& columns, std::size_t coefficient, std::size_t splat) {
  const std::size_t others = columns.harmonics.size() / 3 - 1;
  glm::vec3 value;
  for (std::size_t channel = 0; channel < 3; ++channel) {
    const std::size_t column = coefficient == 0 ? channel : 3 + channel * others + coefficient - 1;
    value[static_cast<int>(channel)] = static_cast<float>(columns.harmonics[column].at(splat));
  }
  return value;
}

bool is_finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

std::optional<Splat> splat_at(const SplatColumns& columns, std::size_t i) {
  Splat splat;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    splat.center[static_cast<int>(axis)] = static_cast<float>(columns.center[axis].at(i));
    splat.sigma[static_cast<int>(axis)] = static_cast<float>(std::exp(columns.log_sigma[axis].at(i)));
  }
  const glm::dvec4 rotation(columns.rotation[1].at(i), columns.rotation[2].at(i), columns.rotation[3].at(i),
                            columns.rotation[0].at(i));
  const double length = glm::length(rotation);
  const double opacity = 1 / (1 + std::exp(-columns.opacity.at(i)));
  if (!is_finite(splat.center) || !is_finite(splat.sigma) || splat.sigma == glm::vec3(0)) return {};
  if (!(length > 0) || !std::isfinite(length) || std::isnan(opacity)) return {};
  splat.rotation = glm::vec4(rotation / length);
  splat.opacity = static_cast<float>(opacity);
  return splat;
}

}  // namespace

void check_splat_count(const std::filesystem::path& file, std::size_t count) {
  if (count == 0) fail_at({.file = file.string()}, "holds nothing to draw");
  if (count > kMaxSplats) {
    fail_at({.file = file.string()},
            "has " + std::to_string(count) + " Gaussian splats, expected at most " + std::to_string(kMaxSplats));
  }
}

ImportedScene splat_scene(const SplatColumns& columns) {
  check_splat_count(columns.file, columns.count);
  const auto cloud = std::make_shared<SplatCloud>();
  cloud->degree = degree_of(columns);
  const std::size_t coefficients = harmonics_count(cloud->degree);
  cloud->splats.reserve(columns.count);
  cloud->harmonics.reserve(columns.count * coefficients);
  for (std::size_t i = 0; i < columns.count; ++i) {
    const std::optional<Splat> splat = splat_at(columns, i);
    bool is_whole = splat.has_value();
    for (std::size_t c = 0; is_whole && c < coefficients; ++c) {
      cloud->harmonics.push_back(harmonic(columns, c, i));
      is_whole = is_harmonic(cloud->harmonics.back());
    }
    if (is_whole) cloud->splats.push_back(*splat);
    cloud->harmonics.resize(cloud->splats.size() * coefficients);
  }
  const std::size_t left_out = columns.count - cloud->splats.size();
  return splat_scene(columns.file, cloud, left_out);
}

ImportedScene splat_scene(const std::filesystem::path& file, std::shared_ptr<const SplatCloud> cloud,
                          std::size_t left_out) {
  check_splat_count(file, cloud->splats.size());
  ImportedScene scene;
  if (left_out > 0) {
    scene.warnings.push_back(file.string() + ": " + std::to_string(left_out) +
                             " Gaussian splats are left out, which have numbers that are not finite, harmonics above "
                             "10^6, no rotation or no extent");
  }
  Mesh& mesh = scene.meshes.emplace_back();
  mesh.name = file.stem().string();
  mesh.splats = std::move(cloud);
  ImportedMaterial& material = scene.materials.emplace_back();
  material.is_fallback = true;
  material.material.unlit = true;
  ImportedNode node;
  node.name = mesh.name;
  node.shapes = {{0, 0}};
  scene.nodes.push_back(std::move(node));
  return scene;
}

}  // namespace simvis
