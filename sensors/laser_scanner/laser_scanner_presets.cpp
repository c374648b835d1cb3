#include "sensors/laser_scanner/laser_scanner_presets.h"

namespace simvis {
namespace {

// One turn of the mirror at 75 Hz measures every degree; two turns, half a degree apart, make a scan of 26.67 ms.
constexpr PresetAttribute kLms200[] = {
    {"samples", "361"},  {"min_angle", "-90"},         {"max_angle", "90"},      {"range_min", "0.05"},
    {"range_max", "80"}, {"range_resolution", "0.01"}, {"range_noise", "0.005"}, {"rate", "37.5"},
};

// 271 beams of a turn of 360 degrees at 15 Hz.
constexpr PresetAttribute kTim551[] = {
    {"samples", "271"},      {"min_angle", "-135"},  {"max_angle", "135"}, {"range_min", "0.05"}, {"range_max", "10"},
    {"range_noise", "0.02"}, {"range_bias", "0.06"}, {"rate", "15"},       {"sweep", "0.05"},
};

// Steps 0 to 1080 of 1440 per turn.
constexpr PresetAttribute kUtm30lx[] = {
    {"samples", "1081"},     {"min_angle", "-135"}, {"max_angle", "135"},
    {"range_min", "0.1"},    {"range_max", "30"},   {"range_resolution", "0.001"},
    {"range_noise", "0.01"}, {"rate", "40"},        {"sweep", "0.01875"},
};

// Steps 44 to 725 of 1024 per turn, the front is step 384.
constexpr PresetAttribute kUrg04lx[] = {
    {"samples", "682"},    {"min_angle", "-119.53125"}, {"max_angle", "119.8828125"},
    {"range_min", "0.02"}, {"range_max", "5.6"},        {"range_resolution", "0.001"},
    {"rate", "10"},        {"sweep", "0.06650390625"},
};

// 360 samples of a turn at 5.5 Hz: 359 / 360 of 1 / 5.5 s.
constexpr PresetAttribute kRplidarA1[] = {
    {"samples", "360"},  {"min_angle", "-180"}, {"max_angle", "179"},          {"range_min", "0.15"},
    {"range_max", "12"}, {"rate", "5.5"},       {"sweep", "0.18131313131313"}, {"sweep_direction", "cw"},
};

// 8000 samples a second at 10 Hz, every 0.45 degrees: 799 / 800 of 0.1 s.
constexpr PresetAttribute kRplidarA2[] = {
    {"samples", "800"}, {"min_angle", "-180"}, {"max_angle", "179.55"},   {"range_max", "12"},
    {"rate", "10"},     {"sweep", "0.099875"}, {"sweep_direction", "cw"},
};

// 300 turns a minute, every degree.
constexpr PresetAttribute kLds01[] = {
    {"samples", "360"},   {"min_angle", "-180"}, {"max_angle", "179"},         {"range_min", "0.12"},
    {"range_max", "3.5"}, {"rate", "5"},         {"range_noise_rel", "0.035"}, {"range_bias_rel", "0.05"},
};
constexpr PresetAttribute kLds02[] = {
    {"samples", "360"}, {"min_angle", "-180"}, {"max_angle", "179"},       {"range_min", "0.16"},
    {"range_max", "8"}, {"rate", "5"},         {"range_bias_rel", "0.03"},
};

constexpr PresetAttribute kVlp16[] = {
    {"pattern", "device:velodyne_vlp16"}, {"firing", "pattern"},  {"range_min", "1"}, {"range_max", "100"},
    {"range_resolution", "0.002"},        {"range_bias", "0.03"}, {"rate", "10"},
};
constexpr PresetAttribute kHdl32e[] = {
    {"pattern", "device:velodyne_hdl32e"}, {"firing", "pattern"}, {"range_min", "1"}, {"range_max", "100"},
    {"range_resolution", "0.002"},         {"rate", "10"},
};
constexpr PresetAttribute kVls128[] = {
    {"pattern", "device:velodyne_vls128"}, {"firing", "pattern"}, {"range_min", "0.4"}, {"range_max", "300"},
    {"range_resolution", "0.004"},         {"rate", "10"},
};
constexpr PresetAttribute kOs0x32[] = {
    {"pattern", "device:ouster_os0_32"}, {"firing", "pattern"}, {"range_min", "0.3"}, {"range_max", "55"},
    {"range_resolution", "0.001"},       {"rate", "10"},
};
constexpr PresetAttribute kOs0x128[] = {
    {"pattern", "device:ouster_os0_128"}, {"firing", "pattern"}, {"range_min", "0.3"}, {"range_max", "55"},
    {"range_resolution", "0.001"},        {"rate", "10"},
};
constexpr PresetAttribute kOs1x32[] = {
    {"pattern", "device:ouster_os1_32"}, {"firing", "pattern"},   {"range_min", "0.3"},   {"range_max", "120"},
    {"range_resolution", "0.001"},       {"range_noise", "0.01"}, {"range_bias", "0.03"}, {"rate", "10"},
};
constexpr PresetAttribute kOs1x64[] = {
    {"pattern", "device:ouster_os1_64"}, {"firing", "pattern"},    {"range_min", "0.8"}, {"range_max", "120"},
    {"range_resolution", "0.001"},       {"range_noise", "0.015"}, {"rate", "10"},
};
constexpr PresetAttribute kOs1x128[] = {
    {"pattern", "device:ouster_os1_128"}, {"firing", "pattern"},   {"range_min", "0.3"},   {"range_max", "120"},
    {"range_resolution", "0.001"},        {"range_noise", "0.01"}, {"range_bias", "0.03"}, {"rate", "10"},
};
constexpr PresetAttribute kOs2x32[] = {
    {"pattern", "device:ouster_os2_32"}, {"firing", "pattern"}, {"range_min", "0.3"}, {"range_max", "240"},
    {"range_resolution", "0.001"},       {"rate", "10"},
};
constexpr PresetAttribute kOs2x128[] = {
    {"pattern", "device:ouster_os2_128"}, {"firing", "pattern"}, {"range_min", "0.3"}, {"range_max", "240"},
    {"range_resolution", "0.001"},        {"rate", "10"},
};
constexpr PresetAttribute kXt32[] = {
    {"pattern", "device:hesai_xt32"}, {"firing", "pattern"}, {"range_min", "0.05"}, {"range_max", "120"},
    {"range_resolution", "0.004"},    {"rate", "10"},
};
constexpr PresetAttribute kXt16[] = {
    {"pattern", "device:hesai_xt16"}, {"firing", "pattern"}, {"range_min", "0.05"}, {"range_max", "120"},
    {"range_resolution", "0.004"},    {"rate", "10"},
};
constexpr PresetAttribute kPandar64[] = {
    {"pattern", "device:hesai_pandar64"}, {"firing", "pattern"}, {"range_min", "0.3"}, {"range_max", "200"},
    {"range_resolution", "0.004"},        {"rate", "10"},
};
constexpr PresetAttribute kQt64[] = {
    {"pattern", "device:hesai_qt64"}, {"firing", "pattern"}, {"range_min", "0.1"}, {"range_max", "60"},
    {"range_resolution", "0.004"},    {"rate", "10"},
};

constexpr std::string_view kHesaiUnit =
    "Hesai, HesaiLidar_General_SDK 5fbcbb8: angles, and the unit of 4 mm of its packets; limits: TIER IV, nebula "
    "606ac41, decoders/pandar_*.hpp";
constexpr std::string_view kHesaiXtNotes =
    "Not found: the reflectivity of the largest range, noise and bias. Channels fire at the times of the SDK.";
constexpr std::string_view kHesaiNotes =
    "Not found: the reflectivity of the largest range, noise, bias and the firing times of channels; a column fires at "
    "once.";

constexpr std::string_view kOusterUnit =
    "Ouster, metadata of this model in ouster-sdk 46b7bce, tests/pcaps; range unit of the profile "
    "RNG19_RFL8_SIG16_NIR16; smallest range: Ouster, sensor documentation, Minimum Range Threshold (up to revision 6); "
    "largest range: ytldsimage/OSLidarWiki, docs/Catalog.md";
constexpr std::string_view kOusterNotes =
    "Not found: the reflectivity of the largest range, noise and bias. Columns fire at the times of the metadata.";
constexpr std::string_view kOs1Unit =
    "Ouster, metadata of this model in ouster-sdk 46b7bce, tests/pcaps; range unit of the profile "
    "RNG19_RFL8_SIG16_NIR16; Ouster, OS1 data sheet, revision C, firmware 2.4, 09/29/22";
constexpr std::string_view kOs1Notes =
    "120 m: 80 % Lambertian, more than 50 % detected at 100 klx; 100 m with more than 90 %; 55 m at 10 %. White "
    "noise: 1 cm is the precision (one deviation, 10 %) from 1 to 20 m; it is 0.7 cm below and 2 cm to 50 m, 5 cm "
    "beyond. Bias: the accuracy of 3 cm on Lambertian targets; it is 10 cm on retroreflectors.";

constexpr SensorPreset kPresets[] = {
    {"sick_lms200", "SICK LMS 200, 180 degrees in steps of 0.5",
     "SICK, Technical Description LMS 200 / LMS 211 / LMS 220 / LMS 221 / LMS 291, 8 008 970/06-2003, Technical data",
     kLms200,
     "White noise: the statistical error, one deviation. Not taken over: the systematic error, the reflectivity of the "
     "largest range, and the two interlaced turns of a scan; all beams leave at once."},
    {"sick_tim551", "SICK TiM551, 270 degrees in steps of 1",
     "SICK, TiM55x / TiM56x, 8015886/YDR0/2014-08-27, p. 4 (errors); TiM55x/56x/57x Technical information, "
     "8015883/YZK8/2016-07-07, p. 25 (15 Hz, steps, angles from -45 to 225 degrees); limits: uos/sick_tim 197a052, "
     "sick_tim551_2050001_parser.cpp",
     kTim551,
     "White noise: the statistical error, one deviation. Bias: the systematic error of 60 mm. Limits are those of "
     "the driver. Not found: the reflectivity of the largest range."},
    {"hokuyo_utm30lx", "Hokuyo UTM-30LX, 270 degrees in steps of 0.25",
     "Hokuyo, Scanning Laser Range Finder UTM-30LX/LN Specification, C-42-3615, Specifications; steps and direction: "
     "Communication Protocol Specification for SCIP2.0, C-42-03320B, p. 5, table 2",
     kUtm30lx,
     "White noise: the repeatability, which is 10 mm up to 10 m and below 30 mm beyond. Not taken over: accuracy, and "
     "the reflectivity of the largest range."},
    {"hokuyo_urg04lx", "Hokuyo URG-04LX, 240 degrees in steps of 0.35",
     "Hokuyo, Communication Protocol Specification for SCIP2.0, C-42-03320B, p. 5 (steps, direction) and p. 21 "
     "(limits, 600 turns a minute)",
     kUrg04lx, "Ranges are in millimetres. Not found: the reflectivity of the largest range, noise and bias."},
    {"rplidar_a1", "Slamtec RPLIDAR A1M8, 360 beams at 5.5 turns a second",
     "Slamtec, RPLIDAR A1 Introduction and Datasheet, model A1M8, p. 7", kRplidarA1,
     "12 m: on white objects. Beams leave evenly over a turn, clockwise. The resolution is below 0.5 mm up to 1.5 m "
     "and below 1 % beyond, and is not simulated. Not stated: noise and bias."},
    {"rplidar_a2", "Slamtec RPLIDAR A2M8, 800 beams at 10 turns a second",
     "Slamtec, RPLIDAR A2 Introduction and Datasheet, model A2M8, rev. 2.5, Introduction", kRplidarA2,
     "Beams leave evenly over a turn, clockwise. Not found: the smallest range (the default of laser_scanner holds), "
     "the reflectivity of the largest, noise and bias."},
    {"lds_01", "Hitachi-LG LDS-01 (HLS-LFCD2) of TurtleBot3, 360 beams at 5 turns a second",
     "ROBOTIS, e-Manual, TurtleBot3, Appendix LDS-01, Measurement Performance Specifications", kLds01,
     "White noise: the precision of 3.5 % from 0.5 m on; it is 10 mm below. Bias: the accuracy of 5 % from 0.5 m on; "
     "it is 15 mm below. Not stated: the reflectivity of the largest range, and when beams leave; all leave at once."},
    {"lds_02", "LDS-02 of TurtleBot3, 360 beams at 5 turns a second",
     "ROBOTIS, e-Manual, TurtleBot3, Appendix LDS-02, Measurement Performance Specifications", kLds02,
     "Bias: the accuracy of 3 % from 0.3 to 6 m; it is 10 mm below and 5 % beyond. Not stated: noise, the "
     "reflectivity of the largest range, and when beams leave; all leave at once."},
    {"velodyne_vlp16", "Velodyne VLP-16 (Puck), 16 rings, 10 turns a second",
     "Velodyne LiDAR, Puck data sheet, 63-9229 Rev. F and K; VLP-16 User Manual, 63-9243 Rev. D, pp. 49 and 54; "
     "smallest range: first revisions of the manual, p. 3",
     kVlp16,
     "Bias: the typical accuracy of 3 cm across most channels in front of a wall. Not stated: noise, and the "
     "reflectivity of the largest range."},
    {"velodyne_hdl32e", "Velodyne HDL-32E, 32 rings, 10 turns a second",
     "Velodyne LiDAR, HDL-32E User Manual, pp. 2 and 6 (limits) and 10; 63-9277 Rev. D; envelope drawing 86-0106 Rev. "
     "B, p. 2",
     kHdl32e, "Not found: the reflectivity of the largest range, noise and bias."},
    {"velodyne_vls128", "Velodyne VLS-128 (Alpha Prime), 128 rings, 10 turns a second",
     "Velodyne LiDAR, VLS-128 User Manual, pp. 49, 54 and 61; angles of velodyne_decoder 3.1.0, calib_db.cpp; limits: "
     "ros-drivers/velodyne 927da47, VLS128-velodyne_transform_node-params.yaml",
     kVls128, "Limits are those of the driver. Not found: the reflectivity of the largest range, noise and bias."},
    {"ouster_os0_32", "Ouster OS0-32, 1024 columns, 10 turns a second", kOusterUnit, kOs0x32, kOusterNotes},
    {"ouster_os0_128", "Ouster OS0-128, 1024 columns, 10 turns a second", kOusterUnit, kOs0x128, kOusterNotes},
    {"ouster_os1_32", "Ouster OS1-32, 1024 columns, 10 turns a second", kOs1Unit, kOs1x32, kOs1Notes},
    {"ouster_os1_64", "Ouster OS1-64 of the first generation, 1024 columns, 10 turns a second",
     "Ouster, nominal angles in ouster-sdk 46b7bce, ouster_core/src/sensor_info.cpp; Ouster, OS1 data sheet of the "
     "first generation (128, 64 or 16 beams, 850 nm)",
     kOs1x64,
     "120 m: 80 % Lambertian, 100 klx; 40 m at 10 %. White noise: the repeatability of 1.5 cm (one deviation) at a "
     "signal to noise ratio above 250; it is 3 cm at 100 and 10 cm at 12. No bias on Lambertian targets. The sheet's "
     "resolution is 1.2 cm; the unit of the packets is used."},
    {"ouster_os1_128", "Ouster OS1-128, 1024 columns, 10 turns a second", kOs1Unit, kOs1x128, kOs1Notes},
    {"ouster_os2_32", "Ouster OS2-32, 1024 columns, 10 turns a second", kOusterUnit, kOs2x32, kOusterNotes},
    {"ouster_os2_128", "Ouster OS2-128, 1024 columns, 10 turns a second", kOusterUnit, kOs2x128, kOusterNotes},
    {"hesai_xt32", "Hesai PandarXT-32, 2000 columns, 10 turns a second", kHesaiUnit, kXt32, kHesaiXtNotes},
    {"hesai_xt16", "Hesai PandarXT-16, 2000 columns, 10 turns a second", kHesaiUnit, kXt16, kHesaiXtNotes},
    {"hesai_pandar64", "Hesai Pandar64, 1800 columns, 10 turns a second", kHesaiUnit, kPandar64, kHesaiNotes},
    {"hesai_qt64", "Hesai PandarQT, 600 columns, 10 turns a second", kHesaiUnit, kQt64, kHesaiNotes},
};

}  // namespace

std::span<const SensorPreset> laser_scanner_presets() { return kPresets; }

}  // namespace simvis
