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

constexpr PresetAttribute kD405[] = {
    {"width", "1280"}, {"height", "720"}, {"hfov", "87"}, {"baseline", "0.018"}, {"depth_min", "0.1"}, {"rate", "30"},
};
constexpr PresetAttribute kD455[] = {
    {"width", "1280"}, {"height", "720"}, {"hfov", "87"}, {"baseline", "0.095"}, {"depth_min", "0.4"}, {"rate", "30"},
};

// A focal length of 882.5 pixels across 1280 is 71.9 degrees; 95 pixels are 882.5 x 0.075 / 95 = 0.697 m.
constexpr PresetAttribute kOakD[] = {
    {"width", "1280"},     {"height", "800"},      {"hfov", "71.9"},
    {"baseline", "0.075"}, {"depth_min", "0.697"}, {"rate", "30"},
};
constexpr PresetAttribute kZed2i[] = {
    {"width", "1280"},    {"height", "720"},   {"hfov", "110"}, {"baseline", "0.12"},
    {"depth_min", "0.3"}, {"depth_max", "20"}, {"rate", "30"},
};

constexpr std::string_view kRealSense =
    "Grunnet-Jepsen et al., Subpixel Linearity Improvement for Intel RealSense Depth Camera D400 Series, rev. 1.3 "
    "(columns, field of view, step), and Tuning depth cameras for best performance (rows); baseline: place of the "
    "right imager in Intel's package realsense2_description (_d415.urdf.xacro, _d435.urdf.xacro); rate: of SimVis";

constexpr std::string_view kRealSenseNotes =
    "Not stated: the smallest and the largest depth, and the noise of the disparity, which depends on the texture of "
    "the scene.";
constexpr SensorPreset kPresets[] = {
    {"kinect_v1", "Microsoft Kinect of 2010: infrared camera and projector",
     "Khoshelham and Oude Elberink, Accuracy and Resolution of Kinect Depth Data for Indoor Mapping Applications, "
     "Sensors 12(2), 2012, sections 3 and 4",
     kKinect,
     "White noise: the random error of the disparity, half a unit. The reflectivity of the largest depth is not "
     "stated."},
    {"realsense_d405", "Intel RealSense D405, 1280 x 720: two imagers",
     "Intel, D405 product page (field of view) and D400 Series Datasheet, 337029, table of Min-Z, as DigiKey's forum "
     "cites it; baseline: realsense-ros 1cbd81b, _d405.urdf.xacro",
     kD405,
     "Second-hand: not compared with Intel's data sheet. Ideal range: 7 to 50 cm. Rate: of SimVis. Not stated: a "
     "largest depth, the noise of the disparity and its step; the accuracy of 2 % at 50 cm is not taken over."},
    {"realsense_d415", "Intel RealSense D415, 1280 x 720: two imagers", kRealSense, kD415, kRealSenseNotes},
    {"realsense_d435", "Intel RealSense D435, 848 x 480: two imagers", kRealSense, kD435, kRealSenseNotes},
    {"realsense_d455", "Intel RealSense D455, 1280 x 720: two imagers",
     "worv-ai/CostNav, docs/depth_sensors_specifications.md, after Intel's D400 Series Datasheet (field of view, "
     "smallest depth); baseline: realsense-ros 1cbd81b, _d455.urdf.xacro",
     kD455,
     "Second-hand: not compared with Intel's data sheet. Optimal range: 0.6 to 6 m. Rate: of SimVis. Not stated: a "
     "largest depth, the noise of the disparity and its step; the accuracy of 2 % at 4 m is not taken over."},
    {"oak_d", "Luxonis OAK-D, 1280 x 800: two imagers",
     "Luxonis documentation, FAQ on stereo depth: focal length of 882.5 pixels, baseline of 7.5 cm, and 70 cm for a "
     "disparity of 95 pixels; pixels: OAK-D data sheet, camera module specifications",
     kOakD, "Rate: of SimVis. Not stated: a largest depth, the noise of the disparity and its step."},
    {"zed_2i", "Stereolabs ZED 2i with 2.1 mm lenses, 1280 x 720",
     "Stereolabs documentation, Depth Settings (0.3 to 20 m); baseline and field of view: ZED Depth Sensors, "
     "encyclopedia.pub, entry 48603, after Stereolabs' data sheet",
     kZed2i,
     "Second-hand: baseline and field of view are not compared with the data sheet. Columns, rows and rate: of SimVis. "
     "Not stated: the reflectivity of the largest depth, the noise of the disparity and its step."},
};

}  // namespace

std::span<const SensorPreset> rgbd_camera_presets() { return kPresets; }

}  // namespace simvis
