#include "engine/embree_items.h"

#include <string>
#include <utility>

#include "engine/error.h"

namespace simvis {

// One thread: the tree over items is made anew while its scanners wait, and waking others costs more than it takes.
EmbreeItems::EmbreeItems(RTCIntersectFunctionN on_item, RTCIntersectFunctionN on_triangle)
    : device_(rtcNewDevice("threads=1")),
      on_item_(on_item),
      items_([this, on_triangle](std::shared_ptr<const Mesh> mesh) {
        return std::make_unique<EmbreeMesh>(device_.get(), std::move(mesh), on_triangle);
      }) {
  if (device_ == nullptr)
    throw MachineError("Embree does not start: error " + std::to_string(rtcGetDeviceError(nullptr)));
}

void EmbreeItems::update(const DrawList& list, const glm::dvec3& world_sensor) {
  items_.update(list, world_sensor);
  if (built_ && !items_.restructured() && items_.moved().empty()) return;
  built_ = false;
  build();
  built_ = true;
}

void EmbreeItems::build() {
  if (scene_ == nullptr) {
    geometry_.reset(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_USER));
    rtcSetGeometryUserData(geometry_.get(), this);
    rtcSetGeometryBoundsFunction(geometry_.get(), bounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry_.get(), on_item_);
    rtcSetGeometryBuildQuality(geometry_.get(), RTC_BUILD_QUALITY_LOW);
    scene_.reset(rtcNewScene(device_.get()));
    rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_DYNAMIC);
    rtcSetSceneBuildQuality(scene_.get(), RTC_BUILD_QUALITY_LOW);
    rtcAttachGeometry(scene_.get(), geometry_.get());
  }
  rtcSetGeometryUserPrimitiveCount(geometry_.get(), static_cast<unsigned>(items_.items().size()));
  rtcCommitGeometry(geometry_.get());
  rtcCommitScene(scene_.get());
  check_embree(device_.get());
  ++items_.counters.item_trees_built;
}

void EmbreeItems::bounds(const RTCBoundsFunctionArguments* arguments) {
  const EmbreeItems& tree = *static_cast<const EmbreeItems*>(arguments->geometryUserPtr);
  *arguments->bounds_o = bounds_of(tree.items_.items()[arguments->primID].box);
}

}  // namespace simvis
