// Bare Embree for comparison: ray casts of a draw list in single precision and robust mode, with one flat mesh. Every
// triangle is opaque: masks have no effect.
#pragma once

#include <embree3/rtcore.h>

#include <algorithm>
#include <glm/glm.hpp>
#include <limits>
#include <span>
#include <vector>

#include <simvis/draw_list.h>
#include "bench/embree_handles.h"

namespace simvis::bench {

/// Frames   rays start at `origin` in the frame to which the triangles are transformed in double before they are
///          rounded to float32.
class BareEmbree {
 public:
  /// `config` as for rtcNewDevice(): nullptr takes the newest instruction set of the machine, "isa=avx2" that of
  /// SimVis.
  BareEmbree(const DrawList& list, const glm::dmat4& frame_from_world, const char* config = nullptr);

  /// Casts one ray after the other. ranges_m[i] belongs to directions[i]; +infinity where nothing is hit.
  void cast_singly(std::span<const glm::vec3> directions, std::span<float> ranges_m,
                   const glm::vec3& origin = glm::vec3(0)) const;
  /// Casts in packets of 16 rays.
  void cast_in_packets(std::span<const glm::vec3> directions, std::span<float> ranges_m,
                       const glm::vec3& origin = glm::vec3(0)) const;

 private:
  EmbreeDevice device_;
  EmbreeScene scene_;
};

/// True if a laser passes the material everywhere, without regard to textures and vertex colours. Such items are not
/// part of the flat mesh.
inline bool lets_pass(const Material& material) {
  const float alpha = material.alpha_mode == AlphaMode::blend ? material.base_color.a : 1;
  return material.opacity * alpha < kMinDepthVisibleAlpha;
}

inline std::vector<glm::vec3> flat_corners(const DrawList& list, const glm::dmat4& frame_from_world) {
  std::vector<glm::vec3> corners;
  for (const DrawItem& item : list.items) {
    const Mesh& mesh = *list.meshes[item.mesh];
    if (mesh.topology != Topology::triangles || lets_pass(*list.materials[item.material])) continue;
    const glm::dmat4 placed = frame_from_world * list.world_from_node[item.transform];
    for (const std::uint32_t index : mesh.indices) corners.emplace_back(placed * glm::dvec4(mesh.positions[index], 1));
  }
  return corners;
}

inline BareEmbree::BareEmbree(const DrawList& list, const glm::dmat4& frame_from_world, const char* config)
    : device_(rtcNewDevice(config)) {
  const std::vector<glm::vec3> corners = flat_corners(list, frame_from_world);
  const EmbreeGeometry geometry(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
  void* const positions = rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                  sizeof(glm::vec3), corners.size());
  std::copy(corners.begin(), corners.end(), static_cast<glm::vec3*>(positions));
  auto* const indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
      geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), corners.size() / 3));
  for (std::uint32_t i = 0; i < corners.size(); ++i) indices[i] = i;
  rtcCommitGeometry(geometry.get());
  scene_.reset(rtcNewScene(device_.get()));
  rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
  rtcAttachGeometry(scene_.get(), geometry.get());
  rtcCommitScene(scene_.get());
}

inline void BareEmbree::cast_singly(std::span<const glm::vec3> directions, std::span<float> ranges_m,
                                    const glm::vec3& origin) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  for (std::size_t i = 0; i < directions.size(); ++i) {
    RTCRayHit ray{};
    ray.ray.org_x = origin.x;
    ray.ray.org_y = origin.y;
    ray.ray.org_z = origin.z;
    ray.ray.dir_x = directions[i].x;
    ray.ray.dir_y = directions[i].y;
    ray.ray.dir_z = directions[i].z;
    ray.ray.tfar = std::numeric_limits<float>::infinity();
    ray.ray.mask = ~0u;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_.get(), &context, &ray);
    ranges_m[i] = ray.ray.tfar;
  }
}

inline void BareEmbree::cast_in_packets(std::span<const glm::vec3> directions, std::span<float> ranges_m,
                                        const glm::vec3& origin) const {
  constexpr std::size_t kPacket = 16;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  for (std::size_t first = 0; first < directions.size(); first += kPacket) {
    const std::size_t lanes = std::min(kPacket, directions.size() - first);
    alignas(64) int valid[kPacket] = {};
    RTCRayHit16 rays{};
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const glm::vec3& d = directions[first + lane];
      rays.ray.org_x[lane] = origin.x;
      rays.ray.org_y[lane] = origin.y;
      rays.ray.org_z[lane] = origin.z;
      rays.ray.dir_x[lane] = d.x;
      rays.ray.dir_y[lane] = d.y;
      rays.ray.dir_z[lane] = d.z;
      rays.ray.tfar[lane] = std::numeric_limits<float>::infinity();
      rays.ray.mask[lane] = ~0u;
      rays.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
      valid[lane] = -1;
    }
    rtcIntersect16(valid, scene_.get(), &context, &rays);
    for (std::size_t lane = 0; lane < lanes; ++lane) ranges_m[first + lane] = rays.ray.tfar[lane];
  }
}

}  // namespace simvis::bench
