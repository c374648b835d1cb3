// The intervals of fitted parameters cover the truth as often as they say: 200 recordings made by SimVis with
// parameters that are known, as the data packets of a device whose angles, bias, noise and losses differ from those of
// the scene.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include <simvis/simulation.h>
#include "exchange/fidelity/fidelity.h"
#include "exchange/packets/device_reader.h"
#include "exchange/packets/ouster_packets.h"
#include "sensors/beam_tables/ouster_metadata.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("fidelity");

namespace simvis {
namespace {

constexpr int kSettings = 20, kRecordingsOfSetting = 10, kScansOfRecording = 2;
constexpr int kRecordings = kSettings * kRecordingsOfSetting;
constexpr std::uint32_t kRings = 8, kColumns = 256;
constexpr double kSceneReflectance = 0.6;

// A scanner of eight rings. Its corrections are what the real unit adds to the nominal angles.
BeamTable unit_with(const std::vector<double>& azimuth_deg, const std::vector<double>& elevation_deg) {
  auto device = std::make_shared<ScannerDevice>();
  device->format = PacketFormat::ouster;
  device->name = "Ouster of a test";
  OusterPackets& ouster = device->ouster;
  ouster.columns = kColumns;
  ouster.rate_hz = 10;
  ouster.product_line = "TEST-8";
  ouster.beam_radius_mm = 15;
  ouster.beam_z_mm = 0;
  ouster.lidar_to_sensor = {-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 36, 0, 0, 0, 1};
  for (std::uint32_t ring = 0; ring < kRings; ++ring) {
    // An Ouster counts azimuth clockwise.
    ouster.azimuth_deg.push_back((ring % 2 == 0 ? 1.5 : -1.5) - azimuth_deg[ring]);
    ouster.elevation_deg.push_back(14.0 - 4 * ring + elevation_deg[ring]);
  }
  return ouster_beam_table(device, kColumns);
}

// The sensor is tilted, so that every ring meets walls at many angles and is sensitive to both of its own.
std::string room_with(const std::string& pattern, const std::string& attributes) {
  return R"(<simvis>
  <part shape="box" size="9 7 5" name="ROOM" insert_at="ROOT"/>
  <element type="material" name="PAINT" insert_at="ROOT" part="ROOM"/>
  <sensor type="laser_scanner" name="LIDAR" insert_at="ROOT" pose_offset="0.5 -0.4 0.2 25 20 10" pattern=")" +
         pattern + R"(" range_min="0.2" range_max="40" intensity="on" reflectivity="on" )" + attributes +
         "/>\n</simvis>\n";
}

void paint(Simulation& simulation, double reflectance) {
  // Boxes are white; without a reflectance of its own, that of a material is the mean of its colour.
  for (const char* const color : {"red", "green", "blue"}) simulation.set("PAINT", color, reflectance);
}

// A device whose ranges are off by this. Its reflectivity is that of the true range: a device calibrates it with what
// it has, and the packet's would otherwise follow the noise.
void add_bias(double bias_m, Scan& scan) {
  const SharedNumbers<double> reflectivity = scan.channel("reflectivity");
  REQUIRE(!reflectivity.empty());
  REQUIRE(!scan.channel("intensity").empty());
  const std::span<float> ranges_m = scan.edit_ranges().range_m;
  std::vector<double> powers(ranges_m.size());
  for (std::size_t i = 0; i < ranges_m.size(); ++i) {
    ranges_m[i] += static_cast<float>(bias_m);  // infinities stay
    powers[i] = reflectivity[i] / 100 / (double{ranges_m[i]} * ranges_m[i]);
  }
  scan.clear_channels();  // packets have the intensity alone
  scan.add_channel({.name = "intensity", .format = "%.9g"}, std::move(powers));
}

std::string attribute(const char* name, double value) {
  return std::string(name) + "=\"" + format_number(value) + "\" ";
}

/// How often the interval of a parameter covers its truth.
struct Coverage {
  int recordings = 0, covered = 0, undetermined = 0;
  double sum = 0, squares = 0;  // of errors in units of half the interval

  void add(const FittedNumber& number, double truth) {
    if (!number.determined) {
      ++undetermined;
      return;
    }
    ++recordings;
    covered += number.low <= truth && truth <= number.high;
    const double error = 2 * (number.value - truth) / std::max(number.high - number.low, 1e-12);
    sum += error;
    squares += error * error;
  }
};

/// The probability of from `first` to `last` successes of `tries`, each with this probability.
double binomial(int first, int last, int tries, double probability) {
  double sum = 0;
  for (int k = first; k <= last; ++k) {
    sum += std::exp(std::lgamma(tries + 1) - std::lgamma(k + 1) - std::lgamma(tries - k + 1) +
                    k * std::log(probability) + (tries - k) * std::log1p(-probability));
  }
  return sum;
}

/// A value that chi-square with so many degrees of freedom falls below as often as the normal distribution falls below
/// -`deviations`, by Wilson and Hilferty.
double chi_square_low(int degrees, double deviations) {
  const double spread = 2.0 / (9.0 * degrees);
  return degrees * std::pow(1 - spread - deviations * std::sqrt(spread), 3);
}

/// Checks that as many successes as there are, or fewer, and as many or more, are likelier than `false_alarm`.
void check_likely(int successes, int tries, double probability, double false_alarm) {
  CAPTURE(successes);
  CAPTURE(tries);
  CHECK(binomial(0, successes, tries, probability) > false_alarm);
  CHECK(binomial(successes, tries, tries, probability) > false_alarm);
}

}  // namespace

TEST_CASE("intervals of 95 % cover the known parameters of 200 recordings in 95 % of them") {
  const TemporaryFolder folder;
  const std::vector<double> none(kRings);
  write_text(folder / "nominal.json", ouster_metadata(unit_with(none, none)));
  SimulationDesc desc;
  desc.rate_hz = 10;
  Simulation nominal = Simulation::from_string(room_with("nominal.json", ""), desc, folder.path());
  paint(nominal, kSceneReflectance);
  nominal.step();
  const ComparedScanner scanner{.name = "LIDAR",
                                .list = &nominal.diagnostics().draw_list(),
                                .scan = &nominal.scan("LIDAR"),
                                .range_min_m = 0.2,
                                .range_max_m = 40};
  const auto table = scanner.scan->beam_table;
  REQUIRE(table != nullptr);

  std::mt19937 random(36);
  const auto uniform = [&](double from, double to) { return std::uniform_real_distribution<double>(from, to)(random); };
  std::map<std::string, Coverage> coverages;
  std::vector<double> ring_shares;
  for (int setting = 0; setting < kSettings; ++setting) {
    std::vector<double> azimuth_deg, elevation_deg;
    for (std::uint32_t ring = 0; ring < kRings; ++ring) {
      azimuth_deg.push_back(uniform(-0.3, 0.3));
      elevation_deg.push_back(uniform(-0.3, 0.3));
    }
    const std::string unit = "unit" + std::to_string(setting) + ".json";
    write_text(folder / unit, ouster_metadata(unit_with(azimuth_deg, elevation_deg)));
    const double noise_m = uniform(0.005, 0.03), noise_rel = uniform(0, 0.005), angular_deg = uniform(0, 0.1);
    const double dropout = uniform(0.01, 0.1), power = uniform(0.008, 0.015), power_noise = uniform(0.1, 0.4);
    desc.seed = static_cast<std::uint64_t>(setting);
    Simulation device = Simulation::from_string(
        room_with(unit, attribute("range_noise", noise_m) + attribute("range_noise_rel", noise_rel) +
                            attribute("angular_noise", angular_deg) + attribute("dropout", dropout) +
                            attribute("dropout_power", power) + attribute("dropout_noise", power_noise)),
        desc, folder.path());
    for (int number = 0; number < kRecordingsOfSetting; ++number) {
      const double reflectance = uniform(0.3, 0.95), bias_m = uniform(-0.05, 0.05);
      paint(device, reflectance);
      BeamRecording recording{.source = "test",
                              .rings = kRings,
                              .range_unit_m = 0.001,
                              .max_intensity = 255,
                              .intensity_unit = 1,
                              .has_lost_beams = true};
      const std::unique_ptr<DeviceReader> reader = make_device_reader(*table);
      for (std::uint32_t k = 0; k < kScansOfRecording; ++k) {
        device.step();
        Scan scan = device.scan("LIDAR");
        add_bias(bias_m, scan);
        for (const DevicePacket& packet : ouster_packets(scan, *table, k))
          REQUIRE(reader->add(packet.bytes, recording));
      }
      REQUIRE(recording.beams.size() == std::size_t{kScansOfRecording} * kRings * kColumns);
      const FidelityReport report = compare_recording(std::move(recording), scanner, {});
      const std::pair<const char*, double> truths[] = {
          {"range_bias", bias_m},
          {"range_noise", noise_m},
          {"range_noise_rel", noise_rel},
          {"angular_noise", angular_deg},
          {"intensity_gain", 100 * reflectance / kSceneReflectance},
          {"intensity_angle", 1},
          {"intensity_range", 0},
          {"dropout", dropout},
          // The scene's surfaces are brighter or darker than the recorded ones.
          {"dropout_power", power * kSceneReflectance / reflectance},
          {"dropout_noise", power_noise}};
      for (const auto& each : truths) {
        const FittedParameter* const found = report.find(each.first);
        REQUIRE_MESSAGE(found != nullptr, each.first);
        coverages[each.first].add(found->fitted, each.second);
      }
      REQUIRE(report.rings.size() == kRings);
      Coverage rings;
      for (std::uint32_t ring = 0; ring < kRings; ++ring) {
        rings.add(report.rings[ring].azimuth_deg, azimuth_deg[ring]);
        rings.add(report.rings[ring].elevation_deg, elevation_deg[ring]);
      }
      ring_shares.push_back(static_cast<double>(rings.covered) / rings.recordings);
    }
  }
  // A right interval fails this once in 10,000 times.
  constexpr double kFalseAlarm = 1e-4;
  constexpr double kNormalOfFalseAlarm = 3.719;  // the normal distribution is below minus this once in 10,000 times
  for (const auto& each : coverages) {
    const std::string& name = each.first;
    const Coverage& coverage = each.second;
    CAPTURE(name);
    CAPTURE(coverage.covered);
    MESSAGE(name << ": " << coverage.covered << " of " << coverage.recordings << " covered, " << coverage.undetermined
                 << " not determined, errors of " << coverage.sum / coverage.recordings << " +- "
                 << std::sqrt(coverage.squares / coverage.recordings) << " half intervals");
    // Where all surfaces are bright, no beam is weak enough to tell the receiver's threshold; where all are dark, few
    // beams are above it, whose light is no choice of the brighter ones.
    REQUIRE(coverage.recordings + coverage.undetermined == kRecordings);
    const int rare = name == "dropout_power" || name == "dropout_noise" ? kRecordings / 3
                     : name.starts_with("intensity")                    ? kRecordings / 20
                                                                        : 0;
    CHECK(coverage.undetermined <= rare);
    check_likely(coverage.covered, coverage.recordings, 0.95, kFalseAlarm);
    // Intervals of the right width have errors whose squares sum up to a chi-square. Those of the intensity are 1.3
    // times as wide, because they allow for the rings' angles and for roundings that err alike; 1.5 times is too wide.
    constexpr double kTooWide = 1.5, kDeviationsOf95 = 1.959963984540054;
    CHECK(coverage.squares * kDeviationsOf95 * kDeviationsOf95 * kTooWide * kTooWide >
          chi_square_low(coverage.recordings, kNormalOfFalseAlarm));
  }
  // The angles of one recording depend on each other, those of two do not: the spread over recordings says how far the
  // mean may be off.
  double mean = 0, square = 0;
  for (const double share : ring_shares) {
    mean += share / kRecordings;
    square += share * share / kRecordings;
  }
  const double deviation = std::sqrt((square - mean * mean) / kRecordings);
  CAPTURE(deviation);
  MESSAGE("angles of rings: " << mean << " covered");
  constexpr double kDeviations = 4;  // once in 16,000 times
  CHECK(deviation < 0.01);
  CHECK(std::abs(mean - 0.95) <= kDeviations * deviation);
}

}  // namespace simvis

TEST_SUITE_END();
