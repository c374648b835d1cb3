#include "engine/embree_mesh.h"

#include <string>

#include "engine/error.h"

namespace simvis {

void check_embree(RTCDevice device) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_NONE) return;
  throw MachineError(error == RTC_ERROR_OUT_OF_MEMORY ? "Embree has run out of memory"
                                                      : "Embree failed with error " + std::to_string(error));
}

MeshTree::MeshTree(RTCDevice device, std::shared_ptr<const Mesh> mesh, RTCIntersectFunctionN on_triangle)
    : mesh_(std::move(mesh)), triangles_(static_cast<std::uint32_t>(mesh_->indices.size() / 3)) {
  const glm::dvec3 low(mesh_->bounds_min), high(mesh_->bounds_max);
  centre_ = 0.5 * (low + high);
  radius_ = 0.5 * glm::length(high - low);
  half_size_ = radius_ > 0 ? 0.5 * (high - low) / radius_ : glm::dvec3(0);
  if (triangles_ <= kFew || radius_ == 0) return;
  const EmbreeGeometry geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER));
  rtcSetGeometryUserPrimitiveCount(geometry.get(), triangles_);
  rtcSetGeometryUserData(geometry.get(), this);
  rtcSetGeometryBoundsFunction(geometry.get(), bounds, nullptr);
  rtcSetGeometryIntersectFunction(geometry.get(), on_triangle);
  rtcCommitGeometry(geometry.get());
  scene_.reset(rtcNewScene(device));
  rtcAttachGeometry(scene_.get(), geometry.get());
  rtcCommitScene(scene_.get());
  check_embree(device);
}

void MeshTree::bounds(const RTCBoundsFunctionArguments* arguments) {
  const MeshTree& tree = *static_cast<const MeshTree*>(arguments->geometryUserPtr);
  const std::uint32_t* const index = &tree.mesh_->indices[std::size_t{3} * arguments->primID];
  const glm::dvec3 a(tree.mesh_->positions[index[0]]), b(tree.mesh_->positions[index[1]]),
      c(tree.mesh_->positions[index[2]]);
  const double scale = 1 / tree.radius_;
  *arguments->bounds_o = padded_bounds(scale * (glm::min(a, glm::min(b, c)) - tree.centre_),
                                       scale * (glm::max(a, glm::max(b, c)) - tree.centre_), kPadding);
}

}  // namespace simvis
