#include "exchange/fidelity/fidelity.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <tuple>

#include <simvis/error.h>
#include <simvis/location.h>
#include "exchange/fidelity/light_fit.h"
#include "exchange/fidelity/range_fit.h"
#include "exchange/fidelity/recordings.h"
#include "exchange/fidelity/scene_beams.h"

namespace simvis {
namespace {

constexpr double kDegrees = 57.29577951308232;

FittedNumber number_of(const LeastSquaresFit& fit, std::size_t unknown, double unit = 1) {
  const double half = fit.half_width * fit.deviation[unknown];
  return {unit * fit.value[unknown], unit * (fit.value[unknown] - half), unit * (fit.value[unknown] + half),
          fit.determined[unknown]};
}

// The square root of a fitted number, which cannot be negative.
FittedNumber root_of(const FittedNumber& square, double unit = 1) {
  const auto root = [&](double value) { return unit * std::sqrt(std::max(value, 0.0)); };
  return {root(square.value), root(square.low), root(square.high), square.determined};
}

class Comparison {
 public:
  Comparison(BeamRecording recording, const ComparedScanner& scanner, const FidelityDesc& desc)
      : recording_(std::move(recording)), scanner_(scanner), desc_(desc) {
    // The fits need the beams sorted by ring, and neighbours in azimuth beside each other.
    std::ranges::stable_sort(recording_.beams, {}, [](const RecordedBeam& beam) {
      return std::tuple(beam.ring, azimuth_cluster(beam.azimuth_rad));
    });
    report_ = {.scanner = scanner.name,
               .source = recording_.source,
               .scans = recording_.scans,
               .beams = recording_.beams.size(),
               .fitted_pose = desc.fit_pose};
  }

  FidelityReport compare() {
    SceneBeams scene(scanner_, recording_.beams);
    const RangeFit ranges = fit_ranges(recording_, scene, desc_.fit_pose);
    used_.resize(scene.size());
    expected_.resize(scene.size());
    for (std::size_t i = 0; i < scene.size(); ++i) count(scene[i], i, ranges);
    if (report_.used == 0) {
      throw InputError("no beam of the recording reads a surface of the scene, as scanner " + in_quotes(scanner_.name) +
                       " would: " + std::to_string(report_.outside) + " of " + std::to_string(report_.beams) +
                       " beams meet nothing there, and " + std::to_string(report_.other_surface) +
                       " another surface; expected a scene with the recorded target, and the sensor at its place");
    }
    add_ranges(ranges, scene);
    add_light(ranges, scene);
    return std::move(report_);
  }

 private:
  void count(const SceneBeam& beam, std::size_t i, const RangeFit& ranges) {
    if (beam.use == BeamUse::outside) ++report_.outside;
    if (beam.use == BeamUse::at_edge) ++report_.at_edges;
    if (beam.use == BeamUse::grazing) ++report_.grazing;
    if (beam.use != BeamUse::fitted) return;
    expected_[i] = true;
    if (!std::isfinite(recording_.beams[i].range_m)) {
      ++report_.lost;
    } else if (ranges.residual_m.empty() || std::isnan(ranges.residual_m[i])) {
      ++report_.other_surface;
    } else {
      used_[i] = true;
      ++report_.used;
    }
  }

  void add(std::string name, std::string unit, std::string text, const FittedNumber& number) {
    report_.parameters.push_back({std::move(name), std::move(unit), std::move(text), number});
  }

  void add_ranges(const RangeFit& ranges, const SceneBeams& scene) {
    add("range_bias", "m", "what the device adds to each range", number_of(ranges.angles, 0));
    if (desc_.fit_pose) {
      const char* const axes[] = {"x", "y", "z"};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        add(std::string("position_") + axes[axis], "m", "the sensor's place from that in the scene, in its own frame",
            number_of(ranges.angles, 1 + axis));
      }
      add("roll", "deg", "the sensor's tilt from that in the scene", number_of(ranges.angles, 4, kDegrees));
      add("pitch", "deg", "the sensor's tilt from that in the scene", number_of(ranges.angles, 5, kDegrees));
    }
    add("range_noise", "m", "standard deviation of ranges that is the same at all ranges",
        root_of(number_of(ranges.noise, 0)));
    add("range_noise_rel", "", "standard deviation as a share of the range", root_of(number_of(ranges.noise, 1)));
    add("angular_noise", "deg", "standard deviation of azimuth and of elevation",
        root_of(number_of(ranges.noise, 2), kDegrees));
    double squares = 0;
    for (std::size_t i = 0; i < scene.size(); ++i)
      squares += used_[i] ? ranges.residual_m[i] * ranges.residual_m[i] : 0;
    report_.residual_m = std::sqrt(squares / static_cast<double>(report_.used));
    add_rings(ranges);
    add_range_curves(ranges, scene);
  }

  void add_rings(const RangeFit& ranges) {
    if (ranges.rings == 0) {
      report_.notes.push_back("angles are not fitted: the recording has " + std::to_string(recording_.rings) +
                              " rings, expected at most " + std::to_string(kMaxFittedRings));
      return;
    }
    for (std::uint32_t ring = 0; ring < ranges.rings; ++ring) {
      const std::size_t unknown = first_ring_unknown(desc_.fit_pose) + std::size_t{2} * ring;
      report_.rings.push_back({.ring = ring,
                               .azimuth_deg = number_of(ranges.angles, unknown, kDegrees),
                               .elevation_deg = number_of(ranges.angles, unknown + 1, kDegrees)});
    }
    for (std::size_t i = 0; i < used_.size(); ++i) {
      if (!used_[i]) continue;
      FittedRing& ring = report_.rings[recording_.beams[i].ring];
      ++ring.beams;
      ring.residual_m += ranges.residual_m[i] * ranges.residual_m[i];
    }
    for (FittedRing& ring : report_.rings)
      ring.residual_m = std::sqrt(ring.residual_m / std::max<double>(1, static_cast<double>(ring.beams)));
    std::erase_if(report_.rings, [](const FittedRing& ring) { return ring.beams == 0; });
    ComparedCurve azimuth{"azimuth", "ring", "azimuth, degrees to add"},
        elevation{"elevation", "ring", "elevation, degrees to add"};
    const auto add_point = [](ComparedCurve& curve, std::uint32_t ring, const FittedNumber& number) {
      if (number.determined)
        curve.points.push_back({static_cast<double>(ring), number.value, number.low, number.high, 0});
    };
    for (const FittedRing& ring : report_.rings) {
      add_point(azimuth, ring.ring, ring.azimuth_deg);
      add_point(elevation, ring.ring, ring.elevation_deg);
    }
    report_.curves.push_back(std::move(azimuth));
    report_.curves.push_back(std::move(elevation));
  }

  // Sums of a value over beams of nearly the same x.
  struct Bin {
    double beams = 0, x = 0, value = 0, square = 0, model = 0;

    void add(double its_x, double its_value, double its_model) {
      beams += 1;
      x += its_x;
      value += its_value;
      square += its_value * its_value;
      model += its_model;
    }
    double variance() const { return std::max(0.0, square / beams - value * value / (beams * beams)); }
    CurvePoint mean() const {
      const double half = kDeviationsOf95 * std::sqrt(variance() / beams);
      return {x / beams, value / beams, value / beams - half, value / beams + half, model / beams};
    }
  };

  // A curve of the beams in equal steps of x. `sample` says x, value and model of a beam, or nothing.
  template <typename Sample>
  std::vector<Bin> bins_over(const Sample& sample) const {
    constexpr std::size_t kCurveBins = 24;
    constexpr double kMinBeams = 10;
    double min = std::numeric_limits<double>::infinity(), max = -min;
    for (std::size_t i = 0; i < used_.size(); ++i) {
      const auto each = sample(i);
      if (!each) continue;
      min = std::min(min, std::get<0>(*each));
      max = std::max(max, std::get<0>(*each));
    }
    std::vector<Bin> bins(kCurveBins);
    if (!(max > min)) max = min + 1;
    for (std::size_t i = 0; i < used_.size(); ++i) {
      const auto each = sample(i);
      if (!each) continue;
      const auto& [x, value, model] = *each;
      const auto bin = static_cast<std::size_t>((x - min) / (max - min) * kCurveBins);
      bins[std::min(bin, kCurveBins - 1)].add(x, value, model);
    }
    std::erase_if(bins, [](const Bin& bin) { return bin.beams < kMinBeams; });
    return bins;
  }

  using Sampled = std::optional<std::tuple<double, double, double>>;

  void add_range_curves(const RangeFit& ranges, const SceneBeams& scene) {
    const auto residual = [&](std::size_t i) -> Sampled {
      if (!used_[i]) return std::nullopt;
      return std::tuple(scene[i].range_m, ranges.residual_m[i] + ranges.bias_m,
                        ranges.variance.at(scene[i].range_m, slope_of(scene[i])));
    };
    ComparedCurve bias{"range_bias", "range, m", "recorded - simulated, m"},
        noise{"range_noise", "range, m", "standard deviation, m"};
    for (const Bin& bin : bins_over(residual)) {
      CurvePoint mean = bin.mean();
      mean.model = ranges.bias_m;
      bias.points.push_back(mean);
      const double deviation = std::sqrt(bin.variance()), half = kDeviationsOf95 * deviation / std::sqrt(2 * bin.beams);
      noise.points.push_back({mean.x, deviation, deviation - half, deviation + half, std::sqrt(bin.model / bin.beams)});
    }
    report_.curves.push_back(std::move(bias));
    report_.curves.push_back(std::move(noise));
  }

  void add_light(const RangeFit& ranges, const SceneBeams& scene) {
    const Medium& medium = scanner_.list->medium;
    const SceneBeamOf beam_of = [&](std::size_t i) { return scene[i]; };
    std::vector<bool> sure = used_;
    if (recording_.has_lost_beams) {
      const LossFit losses = fit_losses(recording_, beam_of, medium, expected_);
      leave_out_weak(losses, scene, sure);
      add_losses(losses);
    } else {
      report_.notes.emplace_back("lost beams are not compared: the recording has only beams with a return");
    }
    const std::optional<IntensityFit> light = fit_intensity(recording_, beam_of, medium, sure, ring_deviations(ranges));
    if (light) {
      add_intensity(*light, scene);
    } else {
      report_.notes.emplace_back("intensity is not compared: the recording has too few numbers");
    }
  }

  // Leaves out beams that are often lost, because those of them that return are the brighter ones.
  void leave_out_weak(const LossFit& losses, const SceneBeams& scene, std::vector<bool>& sure) const {
    constexpr double kMaxLoss = 0.01;
    for (std::size_t i = 0; i < sure.size(); ++i) {
      const double power = power_of(scene[i], scanner_.list->medium);
      if (sure[i] && power > 0) sure[i] = losses.at(power) < losses.chance.value + kMaxLoss;
    }
  }

  std::vector<RingDeviation> ring_deviations(const RangeFit& ranges) const {
    const auto deviation = [&](std::size_t unknown) {
      return ranges.angles.determined[unknown] ? ranges.angles.deviation[unknown] : kPriorAngle_rad;
    };
    std::vector<RingDeviation> rings;
    for (std::uint32_t ring = 0; ring < ranges.rings; ++ring) {
      const std::size_t unknown = first_ring_unknown(desc_.fit_pose) + std::size_t{2} * ring;
      rings.push_back({deviation(unknown), deviation(unknown + 1)});
    }
    return rings;
  }

  void add_intensity(const IntensityFit& light, const SceneBeams& scene) {
    const FittedNumber log_gain = number_of(light.fit, 0);
    add("intensity_gain", "", "intensity of a white surface at a right angle, at 1 m",
        {std::exp(log_gain.value), std::exp(log_gain.low), std::exp(log_gain.high), log_gain.determined});
    add("intensity_angle", "", "exponent of the cosine of the angle of incidence; 1: matte", number_of(light.fit, 1));
    add("intensity_range", "", "exponent of one over the range; 0: calibrated, 2: raw light", number_of(light.fit, 2));
    if (light.saturated > 0) {
      report_.notes.push_back(std::to_string(light.saturated) +
                              " beams with the largest intensity are left out of its fit");
    }
    const auto sample = [&](std::size_t i, double x) -> Sampled {
      const double intensity = recording_.beams[i].intensity;
      if (!used_[i] || !std::isfinite(intensity) || intensity >= recording_.max_intensity ||
          !(scene[i].reflectance > 0))
        return std::nullopt;
      return std::tuple(x, intensity / scene[i].reflectance,
                        light.at(scene[i], scanner_.list->medium) / scene[i].reflectance);
    };
    ComparedCurve by_angle{"intensity_angle", "angle of incidence, degrees", "intensity / reflectance"},
        by_range{"intensity_range", "range, m", "intensity / reflectance"};
    for (const Bin& bin :
         bins_over([&](std::size_t i) { return sample(i, kDegrees * std::acos(std::min(1.0, scene[i].cosine))); })) {
      by_angle.points.push_back(bin.mean());
    }
    for (const Bin& bin : bins_over([&](std::size_t i) { return sample(i, scene[i].range_m); }))
      by_range.points.push_back(bin.mean());
    report_.curves.push_back(std::move(by_angle));
    report_.curves.push_back(std::move(by_range));
  }

  void add_losses(const LossFit& losses) {
    if (losses.bins.empty()) return;
    add("dropout", "", "probability that a beam is lost, whatever it hits", losses.chance);
    add("dropout_power", "1/m^2", "half of the echoes of this power are lost", losses.power);
    add("dropout_noise", "", "standard deviation of the receiver's noise as a share of that", losses.noise);
    ComparedCurve curve{"dropout", "power of the echo, 1/m^2", "share of lost beams"};
    constexpr double kCurveParts = 24;
    double all = 0, before = 0;
    for (const LossBin& bin : losses.bins) all += bin.beams;
    LossBin part;
    for (const LossBin& bin : losses.bins) {
      part.power += bin.power * bin.beams;
      part.beams += bin.beams;
      part.lost += bin.lost;
      before += bin.beams;
      if (part.beams < all / kCurveParts && before < all) continue;
      const double power = part.power / part.beams;
      const FittedNumber share = wilson_interval(part.lost, part.beams);
      curve.points.push_back({power, share.value, share.low, share.high, losses.at(power)});
      part = {};
    }
    report_.curves.push_back(std::move(curve));
  }

  BeamRecording recording_;
  const ComparedScanner& scanner_;
  FidelityDesc desc_;
  FidelityReport report_;
  std::vector<bool> used_, expected_;  // by beam: is fitted; should read the surface
};

}  // namespace

const FittedParameter* FidelityReport::find(std::string_view parameter) const {
  const auto found = std::ranges::find(parameters, parameter, &FittedParameter::name);
  return found == parameters.end() ? nullptr : &*found;
}

FidelityReport compare_recording(BeamRecording recording, const ComparedScanner& scanner, const FidelityDesc& desc) {
  return Comparison(std::move(recording), scanner, desc).compare();
}

FidelityReport compare_recording_file(const std::string& file, const std::string& topic, std::uint32_t scans,
                                      const ComparedScanner& scanner, const FidelityDesc& desc) {
  const std::string extension = std::filesystem::path(file).extension().string();
  if (extension == ".mcap") {
    return compare_recording(read_cloud_messages(file, topic, *scanner.scan, scans), scanner, desc);
  }
  if (extension != ".pcap")
    throw InputError(in_quotes(file) + " has another extension, expected a file .pcap or .mcap");
  if (!topic.empty()) throw InputError("a capture file has no topics, expected none or a file .mcap");
  const std::shared_ptr<const BeamTable>& table = scanner.scan->beam_table;
  if (table == nullptr || table->device == nullptr) {
    throw InputError(
        "sensor " + in_quotes(scanner.name) +
        " does not have the beams of a device whose packets are known, expected pattern=\"device:NAME\", a "
        "preset of Velodyne or Ouster, or the metadata of an Ouster sensor");
  }
  return compare_recording(read_capture(file, *table, scans), scanner, desc);
}

}  // namespace simvis
