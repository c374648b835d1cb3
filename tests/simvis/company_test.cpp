// Where sensors decide which frames there are, each sensor measures what it measures without the others.
#include <doctest/doctest.h>

#include <set>
#include <string>
#include <utility>
#include <vector>

#include <simvis/device.h>
#include <simvis/simulation.h>
#include "tests/support/sensor_bytes.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

constexpr const char* kWorld = R"(
  <part name="WALL" insert_at="ROOT" shape="box" size="0.1 8 4" pose_offset="2.05 0 0 0 0 0"/>
  <part name="T" insert_at="ROOT"/>
  <element type="pose" name="PUT" insert_at="T"/>
  <part name="BALL" insert_at="T" shape="box" size="0.2 0.2 0.2" pose_offset="1 0 0 0 0 0"/>
  <element type="joint" name="ELBOW" insert_at="ROOT" axis="0 1 0"/>)";
constexpr const char* kRandomized = R"(<randomize element="PUT" param="y" min="-0.2" max="0.2"/>)";

/// A sensor whose values have noise, and what else the scene has. The noise of odometry depends on the way of each
/// frame, and so on which frames there are.
struct Noisy {
  std::string type, attributes;
  std::string beside{};
};

const std::vector<Noisy>& noisy_sensors() {
  const std::string pixels = "width='8' height='6' ";
  static const std::vector<Noisy> all = {
      {"imu",
       "gyroscope_stddev='0.01' gyroscope_bias_stddev='0.1' gyroscope_dynamic_bias_stddev='0.1' "
       "gyroscope_dynamic_bias_correlation_time='1'"},
      {"gnss", "horizontal_stddev='1'"},
      {"magnetometer", "stddev='1e-6'"},
      {"barometer", "stddev='10'"},
      {"joint_state", "position_stddev='0.01'"},
      {"range", "stddev='0.01'"},
      {"sonar", "stddev='0.01'"},
      {"beacon", "beacons='BALL' radius='0.2' stddev='0.01'"},
      {"light_sensor", "stddev='1'", "<element type='light' name='SUN' insert_at='ROOT'/>"},
      {"radar", "range_stddev='0.05' angle_step='5'"},
      {"psd", "noise='0.01'"},
      {"camera", pixels + "full_well_e='10000' read_noise_e='50'"},
      {"stereo_camera", pixels + "full_well_e='10000' read_noise_e='50'"},
      {"rgbd_camera", pixels + "disparity_noise='0.1'"},
      {"tof_camera", pixels + "signal_e='10000' read_noise_e='20'"},
      {"thermal_camera", pixels + "netd='0.05'"},
      {"event_camera", pixels + "leak='200' threshold_noise='0.01' latency_noise='1e-5'", kRandomized},
      {"laser_scanner", "samples='21' range_noise='0.01' angular_noise='0.1' dropout='0.2'"},
      {"laser_scanner", "samples='21' return='dual' divergence='0.3' range_noise='0.01'"},
      {"laser_scanner", "samples='21' sunlight='0.1' dropout_power='0.2' dropout_noise='0.1'"},
      {"laser_scanner", "samples='9'", kRandomized},
  };
  return all;
}

/// The values of the sensor S at 0, 0.1, 0.2 and 0.3 s, in the company of others.
std::vector<std::uint64_t> values_of(const Noisy& noisy, const std::string& company) {
  SimulationDesc desc;
  desc.seed = 5;
  desc.frames_when_due = true;
  Simulation simulation =
      Simulation::from_string(kWorld + noisy.beside + "<sensor type='" + noisy.type +
                                  "' name='S' insert_at='ROOT' rate='10' " + noisy.attributes + "/>" + company,
                              desc);
  std::vector<std::uint64_t> values;
  while (values.size() < 4) {
    simulation.step();
    if (std::ranges::find(simulation.measured(), "S") == simulation.measured().end()) continue;
    SensorBytes bytes;
    bytes.add(simulation.measurement("S"));
    values.push_back(bytes.hash());
  }
  return values;
}

TEST_CASE("with frames when sensors are due, another sensor changes no random number") {
  const Device shared;  // all simulations use it, which is not opened again for each
  const std::string company = "<sensor type='altimeter' name='ALT' insert_at='ROOT' rate='30'/>";
  for (const Noisy& noisy : noisy_sensors()) {
    CAPTURE(noisy.type);
    CAPTURE(noisy.attributes);
    const std::vector<std::uint64_t> alone = values_of(noisy, "");
    CHECK(alone == values_of(noisy, company));
    CHECK(std::set(alone.begin(), alone.end()).size() > 1);  // the noise is there
  }
}

}  // namespace
}  // namespace simvis
TEST_SUITE_END();
