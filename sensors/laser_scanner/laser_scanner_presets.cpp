#include "sensors/laser_scanner/laser_scanner_presets.h"

namespace simvis {
namespace {

// One turn of the mirror at 75 Hz measures every degree; two turns, half a degree apart, make a scan of 26.67 ms.
constexpr PresetAttribute kLms200[] = {
    {"samples", "361"},  {"min_angle", "-90"},         {"max_angle", "90"},      {"range_min", "0.05"},
    {"range_max", "80"}, {"range_resolution", "0.01"}, {"range_noise", "0.005"}, {"rate", "37.5"},
};

// Steps 0 to 1080 of 1440 per turn. For noise beyond 10 m the data sheet only states that it is below 30 mm.
constexpr PresetAttribute kUtm30lx[] = {
    {"samples", "1081"}, {"min_angle", "-135"},         {"max_angle", "135"},    {"range_min", "0.1"},
    {"range_max", "30"}, {"range_resolution", "0.001"}, {"range_noise", "0.01"}, {"rate", "40"},
};

// 10 turns per second, minimum range 1 m (first revisions of the manual, p. 3). The accuracy of +-3 cm is used as one
// standard deviation.
constexpr PresetAttribute kVlp16[] = {
    {"pattern", "device:velodyne_vlp16"}, {"range_min", "1"},      {"range_max", "100"},
    {"range_resolution", "0.002"},        {"range_noise", "0.03"}, {"rate", "10"},
};

// The beams of the following are sourced, and the unit of their packets; limits and noise are for the user to set.
constexpr PresetAttribute kHdl32e[] = {
    {"pattern", "device:velodyne_hdl32e"}, {"range_resolution", "0.002"}, {"rate", "10"}};
constexpr PresetAttribute kVls128[] = {
    {"pattern", "device:velodyne_vls128"}, {"range_resolution", "0.004"}, {"rate", "10"}};
constexpr PresetAttribute kOs0x32[] = {
    {"pattern", "device:ouster_os0_32"}, {"range_resolution", "0.001"}, {"rate", "10"}};
constexpr PresetAttribute kOs0x128[] = {
    {"pattern", "device:ouster_os0_128"}, {"range_resolution", "0.001"}, {"rate", "10"}};
constexpr PresetAttribute kOs1x32[] = {
    {"pattern", "device:ouster_os1_32"}, {"range_resolution", "0.001"}, {"rate", "10"}};
constexpr PresetAttribute kOs1x64[] = {
    {"pattern", "device:ouster_os1_64"}, {"range_resolution", "0.001"}, {"rate", "10"}};
constexpr PresetAttribute kOs1x128[] = {
    {"pattern", "device:ouster_os1_128"}, {"range_resolution", "0.001"}, {"rate", "10"}};
constexpr PresetAttribute kOs2x32[] = {
    {"pattern", "device:ouster_os2_32"}, {"range_resolution", "0.001"}, {"rate", "10"}};
constexpr PresetAttribute kOs2x128[] = {
    {"pattern", "device:ouster_os2_128"}, {"range_resolution", "0.001"}, {"rate", "10"}};

constexpr PresetAttribute kXt32[] = {{"pattern", "device:hesai_xt32"}, {"range_resolution", "0.004"}, {"rate", "10"}};
constexpr PresetAttribute kXt16[] = {{"pattern", "device:hesai_xt16"}, {"range_resolution", "0.004"}, {"rate", "10"}};
constexpr PresetAttribute kPandar64[] = {
    {"pattern", "device:hesai_pandar64"}, {"range_resolution", "0.004"}, {"rate", "10"}};
constexpr PresetAttribute kQt64[] = {{"pattern", "device:hesai_qt64"}, {"range_resolution", "0.004"}, {"rate", "10"}};

constexpr std::string_view kHesaiUnit =
    "Hesai, HesaiLidar_General_SDK 5fbcbb8: angles, and the unit of 4 mm of its packets";

constexpr std::string_view kOusterUnit =
    "Ouster, metadata of this model in ouster-sdk 46b7bce, tests/pcaps; range unit of the profile "
    "RNG19_RFL8_SIG16_NIR16";

constexpr SensorPreset kPresets[] = {
    {"sick_lms200", "SICK LMS 200, 180 degrees in steps of 0.5",
     "SICK, Technical Description LMS 200 / LMS 211 / LMS 220 / LMS 221 / LMS 291, 8 008 970/06-2003, Technical data",
     kLms200},
    {"hokuyo_utm30lx", "Hokuyo UTM-30LX, 270 degrees in steps of 0.25",
     "Hokuyo, Scanning Laser Range Finder UTM-30LX/LN Specification, C-42-3615, Specifications; steps: Communication "
     "Protocol Specification for SCIP2.0, C-42-03320B, p. 5, table 2",
     kUtm30lx},
    {"velodyne_vlp16", "Velodyne VLP-16 (Puck), 16 rings, 10 turns a second",
     "Velodyne LiDAR, Puck data sheet, 63-9229 Rev. F; VLP-16 User Manual, 63-9243 Rev. D, pp. 49 and 54", kVlp16},
    {"velodyne_hdl32e", "Velodyne HDL-32E, 32 rings, 10 turns a second",
     "Velodyne LiDAR, HDL-32E User Manual, p. 10; 63-9277 Rev. D; envelope drawing 86-0106 Rev. B, p. 2", kHdl32e},
    {"velodyne_vls128", "Velodyne VLS-128 (Alpha Prime), 128 rings, 10 turns a second",
     "Velodyne LiDAR, VLS-128 User Manual, pp. 49, 54 and 61; angles of velodyne_decoder 3.1.0, calib_db.cpp", kVls128},
    {"ouster_os0_32", "Ouster OS0-32, 1024 columns, 10 turns a second", kOusterUnit, kOs0x32},
    {"ouster_os0_128", "Ouster OS0-128, 1024 columns, 10 turns a second", kOusterUnit, kOs0x128},
    {"ouster_os1_32", "Ouster OS1-32, 1024 columns, 10 turns a second", kOusterUnit, kOs1x32},
    {"ouster_os1_64", "Ouster OS1-64 of the first generation, 1024 columns, 10 turns a second",
     "Ouster, nominal angles in ouster-sdk 46b7bce, ouster_core/src/sensor_info.cpp", kOs1x64},
    {"ouster_os1_128", "Ouster OS1-128, 1024 columns, 10 turns a second", kOusterUnit, kOs1x128},
    {"ouster_os2_32", "Ouster OS2-32, 1024 columns, 10 turns a second", kOusterUnit, kOs2x32},
    {"ouster_os2_128", "Ouster OS2-128, 1024 columns, 10 turns a second", kOusterUnit, kOs2x128},
    {"hesai_xt32", "Hesai PandarXT-32, 2000 columns, 10 turns a second", kHesaiUnit, kXt32},
    {"hesai_xt16", "Hesai PandarXT-16, 2000 columns, 10 turns a second", kHesaiUnit, kXt16},
    {"hesai_pandar64", "Hesai Pandar64, 1800 columns, 10 turns a second", kHesaiUnit, kPandar64},
    {"hesai_qt64", "Hesai PandarQT, 600 columns, 10 turns a second", kHesaiUnit, kQt64},
};

}  // namespace

std::span<const SensorPreset> laser_scanner_presets() { return kPresets; }

}  // namespace simvis
