#include "sensors/thermal_camera/thermal_camera_presets.h"

namespace simvis {
namespace {

// The sheet gives a rate below 9 Hz: every third frame of the 26 Hz of its video is new. It gives no time constant and
// no residual pattern, which are for the user to set.
constexpr PresetAttribute kLepton35[] = {
    {"width", "160"}, {"height", "120"}, {"hfov", "57"}, {"netd", "0.05"}, {"kelvin_per_count", "0.01"},
    {"rate", "8.7"},
};

// The field of view is that of the lens, which is for the user to choose, as are time constant and pattern.
constexpr PresetAttribute kBoson320[] = {{"width", "320"}, {"height", "256"}, {"netd", "0.04"}, {"rate", "60"}};
constexpr PresetAttribute kBoson640[] = {{"width", "640"}, {"height", "512"}, {"netd", "0.04"}, {"rate", "60"}};

constexpr std::string_view kLepton =
    "FLIR Lepton Engineering Datasheet, 500-0659-00-09 rev. 203: general description (pixels, field of view, NETD "
    "below 50 mK, below 9 Hz, video of 26 Hz) and telemetry row C (TLinear of 0.01 or 0.1 K)";
constexpr std::string_view kBoson =
    "FLIR Boson Thermal Imaging Core Datasheet, 102-2013-40 release 340, key specifications (pixels, 60 Hz, NETD as "
    "low as 40 mK at f/1.0); hfov: of the lens, not set";

constexpr std::string_view kBosonNotes =
    "White noise: the NETD at f/1.0. Not stated: the field of view, which is the lens's, the time constant and the "
    "residual pattern.";

constexpr SensorPreset kPresets[] = {
    {"lepton_3_5", "FLIR Lepton 3.5, 160 x 120, high gain", kLepton, kLepton35,
     "White noise: the NETD, which is below 50 mK. Not stated: the time constant and the residual pattern."},
    {"boson_320", "FLIR Boson 320, fast configuration, without a lens: set hfov", kBoson, kBoson320, kBosonNotes},
    {"boson_640", "FLIR Boson 640, fast configuration, without a lens: set hfov", kBoson, kBoson640, kBosonNotes},
};

}  // namespace

std::span<const SensorPreset> thermal_camera_presets() { return kPresets; }

}  // namespace simvis
