// The .msg texts and type hashes that follow from the fields of messages.
#include "exchange/messages/description.h"

#include <doctest/doctest.h>

#include <map>

#include "tests/messages/message_values.h"

TEST_SUITE_BEGIN("messages");

namespace simvis::ros {
namespace {

TEST_CASE("type hashes are those of ROS 2 Jazzy") {
  // As the package rosbags 0.11.9 computes them from the definitions of Jazzy.
  const std::map<std::string_view, std::string> known = {
      {"sensor_msgs/msg/LaserScan", "64c191398013af96509d518dac71d5164f9382553fce5c1f8cca5be7924bd828"},
      {"sensor_msgs/msg/PointCloud2", "9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5"},
      {"sensor_msgs/msg/Image", "d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47"},
      {"sensor_msgs/msg/CompressedImage", "15640771531571185e2efc8a100baf923961a4d15d5569652e6cb6691e8e371a"},
      {"sensor_msgs/msg/CameraInfo", "b3dfd68ff46c9d56c80fd3bd4ed22c7a4ddce8c8348f2f59c299e73118e7e275"},
      {"sensor_msgs/msg/Range", "b42b62562e93cbfe9d42b82fe5994dfa3d63d7d5c90a317981703f7388adff3a"},
      {"stereo_msgs/msg/DisparityImage", "1ec1ff6b5bace919e4544a37f2d96ead9f81783701b7b7a4d97a09325ecf2711"},
      {"tf2_msgs/msg/TFMessage", "e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"},
      {"geometry_msgs/msg/PoseStamped", "10f3786d7d40fd2b54367835614bff85d4ad3b5dab62bf8bca0cc232d73b4cd8"},
      {"geometry_msgs/msg/TwistStamped", "5f0fcd4f81d5d06ad9b4c4c63e3ea51b82d6ae4d0558f1d475229b1121db6f64"},
      {"nav_msgs/msg/Odometry", "3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0"},
      {"nav_msgs/msg/Path", "1957a5bb3cee5da65c4e52e52b65a93df227efce4c20f8458b36e73066ca334b"},
      {"rosgraph_msgs/msg/Clock", "692f7a66e93a3c83e71765d033b60349ba68023a8c689a79e48078bcb5c58564"},
      {"diagnostic_msgs/msg/DiagnosticArray", "5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e"},
      {"rcl_interfaces/msg/ParameterEvent", "043e627780fcad87a22d225bc2a037361dba713fca6a6b9f4b869a5aa0393204"},
      {"sensor_msgs/msg/Imu", "7d9a00ff131080897a5ec7e26e315954b8eae3353c3f995c55faf71574000b5b"},
      {"sensor_msgs/msg/NavSatFix", "62223ab3fe210a15976021da7afddc9e200dc9ec75231c1b6a557fc598a65404"},
      {"sensor_msgs/msg/MagneticField", "e80f32f56a20486c9923008fc1a1db07bbb273cbbf6a5b3bfa00835ee00e4dff"},
      {"sensor_msgs/msg/FluidPressure", "22dfb2b145a0bd5a31a1ac3882a1b32148b51d9b2f3bab250290d66f3595bc32"},
      {"sensor_msgs/msg/JointState", "a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e"},
      {"sensor_msgs/msg/Illuminance", "b954b25f452fcf81a91c9c2a7e3b3fd85c4c873d452aecb3cfd8fd1da732a22d"},
      {"geometry_msgs/msg/WrenchStamped", "8dc3deaf06b2ab281f9f9a742a8961c328ca7cec16e3fd6586d3a5c83fa78f77"},
      {"event_camera_msgs/msg/EventPacket", "d6fa176260b1f37e5a40845305315e150a0f18191241eb64f407442aa29844aa"},
      {"visualization_msgs/msg/MarkerArray", "86cb8800b6fb05b5eff1abd7a56f62a5641d3ae9a1c29e78e67e704f1d067dcf"},
      {"geometry_msgs/msg/TwistWithCovarianceStamped",
       "77b67434531e6529b7a0091357b186b6ebdb17fd9ffd3e0c7ce9d3fb11a44563"},
      {"livox_ros_driver2/msg/CustomMsg", "2eb17e5e35bf5a2d6cd079f3c57f33abf95e5bf7d71b42cddc05daace73d815a"},
      {"vision_msgs/msg/Detection2DArray", "214274120007f4a683866481336b70310268cfa107aebe9d594a6acf75bda968"},
      {"vision_msgs/msg/Detection3DArray", "793f5eab9595ac1c0da07873cc859db42eae51f0ee76056db8562515d830e018"},
      {"std_msgs/msg/Float64", "705ba9c3d1a09df43737eb67095534de36fd426c0587779bda2bc51fe790182a"}};
  std::size_t types = 0;
  test::for_each_type([&]<typename M>() {
    INFO(M::kName);
    REQUIRE(known.contains(M::kName));
    CHECK(type_hash(describe<M>()) == "RIHS01_" + known.at(M::kName));
    ++types;
  });
  CHECK(types == known.size());
}

TEST_CASE("the text of a type is followed by those that it uses, each once") {
  const std::string line(80, '=');
  CHECK(msg_text(describe<Path>()) ==
        "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n" + line +
            "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n" + line +
            "\nMSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n" + line +
            "\nMSG: geometry_msgs/Pose\ngeometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n" + line +
            "\nMSG: geometry_msgs/PoseStamped\nstd_msgs/Header header\ngeometry_msgs/Pose pose\n" + line +
            "\nMSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n" + line +
            "\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n");
  const std::string info = msg_text(describe<CameraInfo>());
  for (const char* each : {"float64[] d\n", "float64[9] k\n", "float64[12] p\n", "bool do_rectify\n"}) {
    CHECK(info.find(each) != std::string::npos);
  }
}

TEST_CASE("the text of a type has the constants of common_interfaces") {
  CHECK(msg_text(describe<NavSatStatus>()) ==
        "int8 STATUS_UNKNOWN=-2\nint8 STATUS_NO_FIX=-1\nint8 STATUS_FIX=0\nint8 STATUS_SBAS_FIX=1\nint8 "
        "STATUS_GBAS_FIX=2\nuint16 SERVICE_UNKNOWN=0\nuint16 SERVICE_GPS=1\nuint16 SERVICE_GLONASS=2\nuint16 "
        "SERVICE_COMPASS=4\nuint16 SERVICE_GALILEO=8\nint8 status\nuint16 service\n");
  const auto has = [](const std::string& text, const char* line) { return text.find(line) != std::string::npos; };
  CHECK(has(msg_text(describe<PointCloud2>()), "\nuint8 FLOAT32=7\nuint8 FLOAT64=8\nstring name\n"));
  CHECK(msg_text(describe<Range>()).starts_with("uint8 ULTRASOUND=0\nuint8 INFRARED=1\nstd_msgs/Header header\n"));
  CHECK(has(msg_text(describe<NavSatFix>()), "uint8 COVARIANCE_TYPE_DIAGONAL_KNOWN=2\n"));
  CHECK(
      has(msg_text(describe<DiagnosticArray>()), "\nbyte OK=0\nbyte WARN=1\nbyte ERROR=2\nbyte STALE=3\nbyte level\n"));
}

}  // namespace
}  // namespace simvis::ros

TEST_SUITE_END();
