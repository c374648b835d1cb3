#include "engine/draw/surface_alpha.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/srgb.h"
#include "engine/draw/surface_map.h"

namespace simvis {

namespace {

// A texture coordinate reduced to two periods, which is all that any wrapping distinguishes.
double reduced(double coordinate, Wrap wrap) {
  if (!std::isfinite(coordinate)) return 0;
  return wrap == Wrap::clamp_to_edge ? std::clamp(coordinate, -1.0, 2.0) : coordinate - 2 * std::floor(coordinate / 2);
}

std::int64_t wrapped(std::int64_t texel, std::int64_t size, Wrap wrap) {
  if (wrap == Wrap::clamp_to_edge) return std::clamp<std::int64_t>(texel, 0, size - 1);
  const std::int64_t period = wrap == Wrap::repeat ? size : 2 * size;
  const std::int64_t inside = (texel % period + period) % period;
  return inside < size ? inside : period - 1 - inside;
}

// The texture at its largest level, filtered and wrapped as its sampler specifies. `value` converts the four bytes of a
// texel to a number or a vector.
template <typename Value>
auto sample(const Texture& texture, const glm::dvec2& uv, const Value& value) {
  const Sampler& sampler = texture.sampler;
  const auto texel = [&](std::int64_t x, std::int64_t y) {
    const std::int64_t column = wrapped(x, texture.width, sampler.wrap_u);
    const std::int64_t row = wrapped(y, texture.height, sampler.wrap_v);
    return value(&texture.rgba[static_cast<std::size_t>(4 * (row * texture.width + column))]);
  };
  const double x = reduced(uv.x, sampler.wrap_u) * texture.width, y = reduced(uv.y, sampler.wrap_v) * texture.height;
  if (sampler.magnify == Filter::nearest) {
    return texel(static_cast<std::int64_t>(std::floor(x)), static_cast<std::int64_t>(std::floor(y)));
  }
  const double left = std::floor(x - 0.5), top = std::floor(y - 0.5);
  const double fx = x - 0.5 - left, fy = y - 0.5 - top;
  const auto column = static_cast<std::int64_t>(left), row = static_cast<std::int64_t>(top);
  return (1 - fy) * ((1 - fx) * texel(column, row) + fx * texel(column + 1, row)) +
         fy * ((1 - fx) * texel(column, row + 1) + fx * texel(column + 1, row + 1));
}

double alpha_of(const std::uint8_t* rgba) { return rgba[3] / 255.0; }

// The linear colour of a texel. Each ray reads four texels, so the results of decode_srgb() for all bytes are kept.
glm::dvec4 color_of(const std::uint8_t* rgba) {
  static const std::array<double, 256> linear = [] {
    std::array<double, 256> values{};
    for (std::size_t byte = 0; byte < values.size(); ++byte)
      values[byte] = decode_srgb(static_cast<double>(byte) / 255);
    return values;
  }();
  return {linear[rgba[0]], linear[rgba[1]], linear[rgba[2]], rgba[3] / 255.0};
}

// The numbers of a texel.
glm::dvec4 numbers_of(const std::uint8_t* rgba) { return glm::dvec4(rgba[0], rgba[1], rgba[2], rgba[3]) / 255.0; }

/// The interpolated attributes of a point of a primitive that its material uses.
struct SurfaceVertex {
  glm::dvec4 color{0};
  glm::dvec2 uv{0};
};

SurfaceVertex interpolated(const Material& material, const Mesh& mesh, std::uint32_t primitive,
                           const glm::dvec3& weights) {
  SurfaceVertex point;
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t index = mesh.indices[std::size_t{3} * primitive + static_cast<std::size_t>(k)];
    const VertexAttributes& vertex = mesh.attributes[index];
    point.color += weights[k] * glm::clamp(glm::dvec4(vertex.color), 0.0, 1.0);
    point.uv += weights[k] * glm::dvec2(vertex.uv[material.uv_set]);
  }
  point.uv = glm::dmat3x2(material.uv_transform) * glm::dvec3(point.uv, 1);
  return point;
}

SurfaceVertex plain_vertex(const Material& material, const glm::dvec2& uv) {
  return {glm::dvec4(1), glm::dmat3x2(material.uv_transform) * glm::dvec3(uv, 1)};
}

SurfaceVertex single_vertex(const Material& material, const Mesh& mesh, std::uint32_t primitive) {
  const VertexAttributes& vertex = mesh.attributes[mesh.indices[primitive]];
  return {glm::clamp(glm::dvec4(vertex.color), 0.0, 1.0),
          glm::dmat3x2(material.uv_transform) * glm::dvec3(glm::dvec2(vertex.uv[material.uv_set]), 1)};
}

float alpha_at(const Material& material, const SurfaceVertex& point) {
  double alpha = static_cast<double>(material.base_color.a) * point.color.a;
  const Texture* const texture = material.base_color_texture.get();
  if (texture != nullptr) alpha *= sample(*texture, point.uv, alpha_of);
  return static_cast<float>(alpha);
}

glm::dvec4 color_at(const Material& material, const SurfaceVertex& point) {
  glm::dvec4 color = glm::dvec4(material.base_color) * point.color;
  const Texture* const texture = material.base_color_texture.get();
  if (texture != nullptr) color *= sample(*texture, point.uv, color_of);
  return color;
}

template <typename Alpha>
bool is_solid_with(const Material& material, const Alpha& alpha) {
  if (material.alpha_mode == AlphaMode::blend) return material.opacity * alpha() >= kMinDepthVisibleAlpha;
  if (material.opacity < kMinDepthVisibleAlpha) return false;
  return material.alpha_mode == AlphaMode::opaque || alpha() >= material.alpha_cutoff;
}

}  // namespace

glm::dvec4 map_value(const SurfaceMap& map, MapKind kind, const Mesh& mesh, std::uint32_t primitive,
                     const glm::dvec3& weights) {
  glm::dvec2 uv(0);
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t index = mesh.indices[std::size_t{3} * primitive + static_cast<std::size_t>(k)];
    uv += weights[k] * glm::dvec2(mesh.attributes[index].uv[map.uv_set]);
  }
  uv = glm::dmat3x2(map.uv_transform) * glm::dvec3(uv, 1);
  return kind == MapKind::emissive ? sample(*map.texture, uv, color_of) : sample(*map.texture, uv, numbers_of);
}

float surface_alpha(const Material& material, const Mesh& mesh, std::uint32_t primitive, const glm::dvec3& weights) {
  return alpha_at(material, interpolated(material, mesh, primitive, weights));
}

glm::dvec4 surface_color(const Material& material, const Mesh& mesh, std::uint32_t primitive,
                         const glm::dvec3& weights) {
  return color_at(material, interpolated(material, mesh, primitive, weights));
}

glm::dvec4 surface_color(const Material& material, const glm::dvec2& uv) {
  return color_at(material, plain_vertex(material, uv));
}

bool is_solid(const Material& material, const Mesh& mesh, std::uint32_t primitive, const glm::dvec3& weights) {
  return is_solid_with(material, [&] { return surface_alpha(material, mesh, primitive, weights); });
}

bool is_solid(const Material& material, const glm::dvec2& uv) {
  return is_solid_with(material, [&] { return alpha_at(material, plain_vertex(material, uv)); });
}

glm::dvec4 point_color(const Material& material, const Mesh& mesh, std::uint32_t primitive) {
  return color_at(material, single_vertex(material, mesh, primitive));
}

bool is_solid_point(const Material& material, const Mesh& mesh, std::uint32_t primitive) {
  return is_solid_with(material, [&] { return alpha_at(material, single_vertex(material, mesh, primitive)); });
}

bool is_solid_throughout(const Material& material) {
  return material.alpha_mode == AlphaMode::opaque && material.opacity >= kMinDepthVisibleAlpha;
}

}  // namespace simvis
