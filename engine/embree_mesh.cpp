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

EmbreeMesh::EmbreeMesh(RTCDevice device, std::shared_ptr<const Mesh> mesh, RTCIntersectFunctionN on_triangle)
    : RayMesh(std::move(mesh)) {
  if (triangles() <= kFew || radius() == 0) return;
  const EmbreeGeometry geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER));
  rtcSetGeometryUserPrimitiveCount(geometry.get(), triangles());
  rtcSetGeometryUserData(geometry.get(), this);
  rtcSetGeometryBoundsFunction(geometry.get(), bounds, nullptr);
  rtcSetGeometryIntersectFunction(geometry.get(), on_triangle);
  rtcCommitGeometry(geometry.get());
  scene_.reset(rtcNewScene(device));
  rtcAttachGeometry(scene_.get(), geometry.get());
  rtcCommitScene(scene_.get());
  check_embree(device);
}

void EmbreeMesh::bounds(const RTCBoundsFunctionArguments* arguments) {
  const EmbreeMesh& tree = *static_cast<const EmbreeMesh*>(arguments->geometryUserPtr);
  const Mesh& mesh = *tree.mesh();
  const std::uint32_t* const index = &mesh.indices[std::size_t{3} * arguments->primID];
  const glm::dvec3 a(mesh.positions[index[0]]), b(mesh.positions[index[1]]), c(mesh.positions[index[2]]);
  const double scale = 1 / tree.radius();
  *arguments->bounds_o = bounds_of(padded_box(scale * (glm::min(a, glm::min(b, c)) - tree.centre()),
                                              scale * (glm::max(a, glm::max(b, c)) - tree.centre()), kPadding));
}

}  // namespace simvis
