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

// 10 turns per second, minimum range 1 m (first revisions of the manual, p. 3). A column is fired every 55.296 us,
// which is 0.199 degrees at this speed. The data sheet's 0.2 degrees give a whole number of columns, so turns repeat.
// The accuracy of +-3 cm is used as one standard deviation.
constexpr PresetAttribute kVlp16[] = {
    {"samples", "1800"},           {"min_angle", "-180"},        {"max_angle", "179.8"}, {"vertical_samples", "16"},
    {"vertical_min_angle", "-15"}, {"vertical_max_angle", "15"}, {"range_min", "1"},     {"range_max", "100"},
    {"range_resolution", "0.002"}, {"range_noise", "0.03"},      {"rate", "10"},
};

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
};

}  // namespace

std::span<const SensorPreset> laser_scanner_presets() { return kPresets; }

}  // namespace simvis
