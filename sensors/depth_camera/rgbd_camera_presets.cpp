#include "sensors/depth_camera/rgbd_camera_presets.h"

namespace simvis {
namespace {

// A focal length of 5.453 mm with pixels of 9.3 um is 586.3 pixels, and so 57.25 degrees across 640 columns. One unit
// of disparity is an eighth of a pixel; the random error is half a unit.
constexpr PresetAttribute kKinect[] = {
    {"width", "640"},
    {"height", "480"},
    {"hfov", "57.25"},
    {"baseline", "0.075"},
    {"depth_min", "0.5"},
    {"disparity_step", "0.125"},
    {"disparity_noise", "0.0625"},
    {"depth_max", "5"},
    {"rate", "30"},
};

// Noise depends on the texture of the scene and is for the user to set.
constexpr PresetAttribute kD415[] = {
    {"width", "1280"}, {"height", "720"}, {"hfov", "65"}, {"baseline", "0.055"}, {"disparity_step", "0.03125"},
    {"rate", "30"},
};
constexpr PresetAttribute kD435[] = {
    {"width", "848"}, {"height", "480"}, {"hfov", "90"}, {"baseline", "0.05"}, {"disparity_step", "0.03125"},
    {"rate", "30"},
};

constexpr std::string_view kRealSense =
    "Grunnet-Jepsen et al., Subpixel Linearity Improvement for Intel RealSense Depth Camera D400 Series, rev. 1.3 "
    "(columns, field of view, step), and Tuning depth cameras for best performance (rows); baseline: place of the "
    "right "
    "imager in Intel's package realsense2_description (_d415.urdf.xacro, _d435.urdf.xacro); rate: of SimVis";

constexpr SensorPreset kPresets[] = {
    {"kinect_v1", "Microsoft Kinect of 2010: infrared camera and projector",
     "Khoshelham and Oude Elberink, Accuracy and Resolution of Kinect Depth Data for Indoor Mapping Applications, "
     "Sensors 12(2), 2012, sections 3 and 4",
     kKinect},
    {"realsense_d415", "Intel RealSense D415, 1280 x 720: two imagers", kRealSense, kD415},
    {"realsense_d435", "Intel RealSense D435, 848 x 480: two imagers", kRealSense, kD435},
};

}  // namespace

std::span<const SensorPreset> rgbd_camera_presets() { return kPresets; }

}  // namespace simvis
