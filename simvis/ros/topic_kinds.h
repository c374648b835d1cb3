// What the topics of sensors end with, one for each kind of message. Those of readings are in
// exchange/messages/from_reading.h, and each output can have one of its own name.
#pragma once

#include <string_view>

namespace simvis {

inline constexpr std::string_view kImage = "image_raw", kCameraInfo = "camera_info", kDepthImage = "depth/image_raw",
                                  kDepthInfo = "depth/camera_info", kDepthMillimetres = "depth/millimetres",
                                  kCountsImage = "thermal/image_raw", kCountsInfo = "thermal/camera_info",
                                  kPoints = "points", kDetections = "detections", kDetections3D = "detections_3d",
                                  kScan = "scan", kLivox = "livox", kEvents = "events", kPose = "pose",
                                  kTwist = "twist";
/// All of them.
inline constexpr std::string_view kTopicKinds[] = {
    kImage,      kCameraInfo,   kDepthImage, kDepthInfo, kDepthMillimetres, kCountsImage, kCountsInfo, kPoints,
    kDetections, kDetections3D, kScan,       kLivox,     kEvents,           kPose,        kTwist};

}  // namespace simvis
