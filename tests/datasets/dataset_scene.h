// A small scene that every format of datasets can hold, and calls of simvis-run with --dataset.
#pragma once

#include <doctest/doctest.h>

#include <filesystem>
#include <map>
#include <string>

#include "tests/support/simvis_run.h"

namespace simvis {

/// Outputs of the camera CAM, 96 x 72, 70 degrees wide.
inline std::string dataset_scene(const std::string& outputs = "color depth instance boxes silhouettes",
                                 const std::string& more = "") {
  return R"(<simvis>
  <part name="FLOOR" insert_at="ROOT" shape="box" size="8 8 0.1" pose_offset="0 0 -0.05 0 0 0"/>
  <part name="WALL" insert_at="ROOT" shape="box" size="0.1 8 3" pose_offset="5 0 1.5 0 0 0"/>
  <part name="TABLE" insert_at="ROOT" shape="box" size="1 1.6 0.7" pose_offset="3 0 0.35 0 0 20"/>
  <part name="AT" insert_at="ROOT" pose_offset="2.2 0.9 0.45 0 0 0"/>
  <element type="pose" name="PUSH" insert_at="AT"/>
  <part name="CHAIR_1" insert_at="AT" shape="box" size="0.4 0.4 0.9"/>
  <part name="CHAIR_2" insert_at="ROOT" shape="box" size="0.4 0.4 0.9" pose_offset="2.2 -0.9 0.45 0 0 0"/>
  <part name="BALL" insert_at="ROOT" shape="sphere" radius="0.2" pose_offset="2.6 0.2 0.9 0 0 0"/>
  <part name="CUT" insert_at="ROOT" shape="box" size="0.5 0.5 0.5" pose_offset="2 1.5 0.25 0 0 0"/>
  <element type="light" name="SUN" insert_at="ROOT"/>
  <element type="label" name="L1" insert_at="ROOT" part="TABLE" class="table" class_id="67"/>
  <element type="label" name="L2" insert_at="ROOT" parts="CHAIR_?" class="chair" class_id="62"/>
  <element type="label" name="L3" insert_at="ROOT" part="BALL" class="ball" class_id="37"/>
  <element type="label" name="L4" insert_at="ROOT" part="CUT" class="chair"/>
  <part name="CAR" insert_at="ROOT" pose_offset="0 0 1.2 0 15 0"/>
  <element type="pose" name="DRIVE" insert_at="CAR"/>
  <randomize element="PUSH" param="y" min="-0.3" max="0.3"/>
  <randomize element="DRIVE" param="yaw" distribution="normal" mean="0" deviation="5"/>
  <sensor type="camera" name="CAM" insert_at="CAR" width="96" height="72" hfov="70" outputs=")" +
         outputs + "\"/>" + more + "</simvis>";
}

inline const std::string kDatasetScanner =
    "<sensor type='laser_scanner' name='SCAN' insert_at='CAR' pose_offset='0.1 0.05 0.1 0 0 0' samples='61' "
    "min_angle='-40' max_angle='40' vertical_samples='9' vertical_min_angle='-20' vertical_max_angle='5' "
    "truth='instance semantic'/>";

inline const std::string kDatasetImu =
    "<sensor type='imu' name='IMU' insert_at='CAR' pose_offset='0.1 0.02 0.05 0 0 3' gyroscope_bias_mean='0.02' "
    "gyroscope_random_walk='1e-3' accelerometer_noise_density='2e-3'/>";

/// A pair of event cameras that look seldom, the left one at the place of CAM, and a view to the right of CAM.
inline const std::string kDatasetEvents =
    "<sensor type='event_camera' name='EV_LEFT' insert_at='CAR' width='96' height='72' hfov='70' step='1' "
    "time_error='0.01'/>"
    "<sensor type='event_camera' name='EV_RIGHT' insert_at='CAR' pose_offset='0 -0.3 0 0 0 0' width='96' height='72' "
    "hfov='70' step='1' time_error='0.01'/><sensor type='camera' name='CAN' insert_at='CAR' pose_offset='0 -0.2 0 0 0 "
    "0' width='96' height='72' "
    "hfov='70' outputs='color'/>";

/// The bytes of all files below a folder, by their names.
inline std::map<std::string, std::string> bytes_below(const std::filesystem::path& folder) {
  std::map<std::string, std::string> bytes;
  for (const std::string& name : files_below(folder)) bytes[name] = read_text(folder / name);
  return bytes;
}

/// Runs simvis-run on `scene`, which must succeed.
inline void make_dataset(const std::filesystem::path& scene, const std::filesystem::path& out, const Strings& more) {
  Strings arguments = {scene.string(), "--frames", "4", "--quiet", "--out", out.string()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const ProcessResult result = run_simvis(arguments);
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
}

}  // namespace simvis
