// Detections of vision_msgs from the boxes of cameras, against the projection of plates.
#include <doctest/doctest.h>

#include <string>

#include "exchange/messages/types/geometry_types.h"
#include "exchange/messages/types/sensor_types.h"
#include "exchange/messages/types/vision_types.h"
#include "tests/messages/recorded_frame.h"

TEST_SUITE_BEGIN("messages");

namespace simvis {
namespace {

using ros::Detection2DArray;
using ros::Detection3DArray;
using ros::test::McapFile;
using test::recorded_frame;

std::string labelled(const std::string& name, const std::string& size, const std::string& place,
                     const std::string& kind) {
  return "<part name='" + name + "' insert_at='ROOT' shape='box' size='" + size + "' pose_offset='" + place +
         "'/><element type='label' name='L_" + name + "' insert_at='ROOT' part='" + name + "' class='" + kind +
         "' class_id='" + (kind[0] == 'p' ? "7" : "8") + "'/>";
}

// Width 64 and 90 degrees: the focal length is 32 px. The face of the plate is at 2 m, 1.2 m wide and 0.8 m high: 9.6
// px to each side, 6.4 px up and down, so columns 22 to 41 and rows 18 to 29 of 64 x 48 show it.
const std::string kLabelledPlate = labelled("PLATE", "0.1 1.2 0.8", "2.05 0 0 0 0 0", "plate");
const std::string kHiddenPlate = labelled("HIDDEN", "0.1 0.4 0.4", "3 0 0 0 0 0", "hidden");

std::string box_camera(const std::string& type, const std::string& more = "") {
  return "<sensor type='" + type +
         "' name='CAM' insert_at='ROOT' width='64' height='48' hfov='90' "
         "outputs='color boxes' " +
         more + "/>";
}

TEST_CASE("a visible object is a detection in the image and in space, a hidden one is none") {
  const McapFile file = recorded_frame(kLabelledPlate + kHiddenPlate + box_camera("camera"), {"/CAM/*"});
  const auto in_image = file.all<Detection2DArray>("/CAM/detections");
  const auto in_space = file.all<Detection3DArray>("/CAM/detections_3d");
  REQUIRE(in_image.size() == 1);
  REQUIRE(in_space.size() == 1);
  CHECK(in_image[0].header.frame_id == "CAM_optical");
  CHECK(in_space[0].header.frame_id == "CAM_optical");
  REQUIRE(in_image[0].detections.size() == 1);
  REQUIRE(in_space[0].detections.size() == 1);
  const ros::Detection2D& flat = in_image[0].detections[0];
  // The middle of the image is the principal point, which CameraInfo has at (31.5, 23.5).
  const auto infos = file.all<ros::CameraInfo>("/CAM/camera_info");
  REQUIRE(infos.size() == 1);
  CHECK(flat.bbox.center.position.x == infos[0].k[2]);
  CHECK(flat.bbox.center.position.y == infos[0].k[5]);
  CHECK(flat.bbox.center.theta == 0);
  CHECK(flat.bbox.size_x == 20);
  CHECK(flat.bbox.size_y == 12);
  REQUIRE(flat.results.size() == 1);
  CHECK(flat.results[0].hypothesis.class_id == "plate");
  CHECK(flat.results[0].hypothesis.score == 1);
  CHECK(flat.header.frame_id == "CAM_optical");
  const ros::Detection3D& solid = in_space[0].detections[0];
  CHECK(solid.id == flat.id);
  CHECK(std::stoul(solid.id) > 0);
  CHECK(solid.results[0].hypothesis.class_id == "plate");
  constexpr double kRounding_m = 1e-12;  // some operations in double on numbers of 2 m
  CHECK(std::abs(solid.bbox.center.position.x) <= kRounding_m);
  CHECK(std::abs(solid.bbox.center.position.y) <= kRounding_m);
  CHECK(std::abs(solid.bbox.center.position.z - 2.05) <= kRounding_m);
  CHECK(solid.results[0].pose.pose.position.z == solid.bbox.center.position.z);
  constexpr double kSize_m = 1e-6;  // vertices of meshes are float32
  CHECK(std::abs(solid.bbox.size.x - 0.1) <= kSize_m);
  CHECK(std::abs(solid.bbox.size.y - 1.2) <= kSize_m);
  CHECK(std::abs(solid.bbox.size.z - 0.8) <= kSize_m);
  // The optical frame from the plate's: x' = -y, y' = -z, z' = x, a third of a turn about (1, -1, 1).
  const ros::Quaternion& q = solid.bbox.center.orientation;
  CHECK(std::abs(std::abs(q.w) - 0.5) <= kRounding_m);
  CHECK(std::abs(q.x / q.w - 1) <= 4 * kRounding_m);
  CHECK(std::abs(q.y / q.w + 1) <= 4 * kRounding_m);
  CHECK(std::abs(q.z / q.w - 1) <= 4 * kRounding_m);
}

TEST_CASE("each view of a stereo camera has detections of its own") {
  const McapFile file =
      recorded_frame(kLabelledPlate + box_camera("stereo_camera", "baseline='0.25'"), {"/CAM/*/detections*"});
  for (const std::string view : {"left", "right"}) {
    CAPTURE(view);
    const auto in_image = file.all<Detection2DArray>("/CAM/" + view + "/detections");
    const auto in_space = file.all<Detection3DArray>("/CAM/" + view + "/detections_3d");
    REQUIRE(in_image.size() == 1);
    REQUIRE(in_image[0].detections.size() == 1);
    CHECK(in_image[0].header.frame_id == "CAM_" + view + "_optical");
    // 0.25 m at 2 m are 4 px.
    CHECK(in_image[0].detections[0].bbox.center.position.x == 31.5 - (view == "left" ? 0 : 4));
    REQUIRE(in_space[0].detections.size() == 1);
    CHECK(std::abs(in_space[0].detections[0].bbox.center.position.x + (view == "left" ? 0 : 0.25)) <= 1e-12);
  }
}

TEST_CASE("the optical frame of detections is a frame of /tf, without an image too") {
  for (const std::string outputs : {"boxes", "color boxes"}) {
    CAPTURE(outputs);
    const McapFile file = recorded_frame(kLabelledPlate +
                                             "<sensor type='camera' name='CAM' insert_at='ROOT' width='64' "
                                             "height='48' hfov='90' outputs='" +
                                             outputs + "'/>",
                                         {"/CAM/*", "/tf_static"});
    const auto found = file.all<Detection2DArray>("/CAM/detections");
    REQUIRE(found.size() == 1);
    std::size_t optical = 0;
    for (const ros::TFMessage& message : file.all<ros::TFMessage>("/tf_static")) {
      for (const ros::TransformStamped& each : message.transforms) {
        if (each.child_frame_id == found[0].header.frame_id) ++optical;
      }
    }
    CHECK(optical == 1);
    CHECK(file.counts().count("/CAM/camera_info") == (outputs == "boxes" ? 0 : 1));
  }
}

TEST_CASE("detections come on request: by a pattern, or by a name in the scene") {
  CHECK(recorded_frame(kLabelledPlate + box_camera("camera"), {}).counts().count("/CAM/detections") == 0);
  const McapFile named = recorded_frame(kLabelledPlate + box_camera("camera", "topics='detections:=/found'"), {});
  CHECK(named.all<Detection2DArray>("/found").size() == 1);
  CHECK(named.counts().count("/CAM/detections_3d") == 0);
  CHECK(recorded_frame(kLabelledPlate + "<sensor type='camera' name='CAM' insert_at='ROOT'/>", {"/CAM/*"})
            .counts()
            .count("/CAM/detections") == 0);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
