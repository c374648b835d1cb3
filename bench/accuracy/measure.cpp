#include "bench/accuracy/measure.h"

#include <algorithm>
#include <chrono>
#include <glm/gtc/matrix_transform.hpp>
#include <set>
#include <thread>
#include <unordered_map>

#include "bench/bare_embree.h"

namespace simvis::bench {

namespace {

constexpr int kHeadingsPerTurn = 8;

/// One turn: the scans that every variant takes.
struct Turn {
  glm::dvec3 station_m;
  std::vector<double> headings_deg{};
  std::vector<TrueScan> truths{};  // by heading
};

/// Results of is_narrow() by beam, shared by all variants of one resolution.
using NarrowBeams = std::unordered_map<std::size_t, bool>;

class Measurement {
 public:
  Measurement(Simulation& simulation, const AccuracyScanner& scanner, std::vector<Variant> variants);

  void take(Turn turn, const BareEmbree& embree);
  std::vector<Result> results() &&;

 private:
  void move_to(const Turn& turn, std::size_t heading);
  void take_variant(std::size_t v, const Turn& turn);
  void take_embree(Result& result, const Turn& turn, const BareEmbree& embree, bool packets);

  Simulation& simulation_;
  const AccuracyScanner& scanner_;
  std::vector<Variant> variants_;
  Truth truth_;
  std::vector<Result> results_;  // in the order of variants_
  Result embree_1_{.method = "embree_1", .peer = true}, embree_16_{.method = "embree_16", .peer = true};
  std::size_t turns_ = 0;
  std::unordered_map<int, std::vector<NarrowBeams>> narrow_;  // of this turn, by resolution and heading
};

Measurement::Measurement(Simulation& simulation, const AccuracyScanner& scanner, std::vector<Variant> variants)
    : simulation_(simulation),
      scanner_(scanner),
      variants_(std::move(variants)),
      truth_(simulation.diagnostics().draw_list()) {
  for (const Variant& v : variants_) results_.push_back({v.method, v.max_error_rel, v.resolution_px});
}

void Measurement::move_to(const Turn& turn, std::size_t heading) {
  simulation_.set(kMount, "x", turn.station_m.x);
  simulation_.set(kMount, "y", turn.station_m.y);
  simulation_.set(kMount, "z", turn.station_m.z);
  simulation_.set(kMount, "yaw", turn.headings_deg[heading]);
}

double scan_ms(const Simulation& simulation) {
  std::int64_t ns = 0;
  for (const StageTime& stage : simulation.diagnostics().stages()) {
    if (stage.name == "plan" || stage.name == "render" || stage.name == "collect") ns += stage.end_ns - stage.start_ns;
  }
  return static_cast<double>(ns) * 1e-6;
}

/// NaN if the method never casts.
float cast_share(const Simulation& simulation, const std::string& sensor) {
  const std::vector<SensorInfo> sensors = simulation.sensors();
  const auto found = std::ranges::find(sensors, sensor, &SensorInfo::name);
  return static_cast<float>(found->number("cast_share").value_or(std::numeric_limits<double>::quiet_NaN()));
}

void Measurement::take(Turn turn, const BareEmbree& embree) {
  narrow_.clear();
  const std::string& cheapest = variants_.front().sensor;
  simulation_.enable(cheapest, true);
  for (std::size_t heading = 0; heading < turn.headings_deg.size(); ++heading) {
    move_to(turn, heading);
    simulation_.step();
    glm::dmat4 world_from_sensor(1.0);
    simulation_.sensor_pose(cheapest, world_from_sensor);
    turn.truths.push_back(truth_.look(world_from_sensor, simulation_.scan(cheapest)));
  }
  simulation_.enable(cheapest, false);
  for (std::size_t i = 0; i < variants_.size(); ++i) take_variant((i + turns_) % variants_.size(), turn);
  take_embree(embree_1_, turn, embree, false);
  take_embree(embree_16_, turn, embree, true);
  ++turns_;
}

void Measurement::take_variant(std::size_t v, const Turn& turn) {
  const Variant& variant = variants_[v];
  Result& result = results_[v];
  std::vector<NarrowBeams>& narrow = narrow_[variant.resolution_px];
  narrow.resize(turn.headings_deg.size());
  simulation_.enable(variant.sensor, true);
  move_to(turn, 0);
  simulation_.step();
  for (std::size_t heading = 0; heading < turn.headings_deg.size(); ++heading) {
    move_to(turn, heading);
    simulation_.step();
    result.times_ms.push_back(static_cast<float>(scan_ms(simulation_)));
    result.cast_shares.push_back(cast_share(simulation_, variant.sensor));
    const Scan& scan = simulation_.scan(variant.sensor);
    const TrueScan& truth = turn.truths[heading];
    const auto is_narrow = [&](std::size_t beam) {
      if (variant.resolution_px == 0) return false;
      const auto [found, isnew] = narrow[heading].try_emplace(beam);
      if (isnew) found->second = truth_.is_narrow(truth, beam, scanner_.lidar, 2.0 / variant.resolution_px);
      return found->second;
    };
    add_errors(truth, scan.range_m, scan.error_bound_m, is_narrow, result.errors);
  }
  simulation_.enable(variant.sensor, false);
}

/// Calls work(first, count) for parts of this number of rays, on as many threads as the ray caster starts for them.
template <typename Work>
void share_out(std::size_t rays, const Work& work) {
  constexpr std::size_t kRaysPerThread = 4096;
  const std::size_t threads =
      std::clamp<std::size_t>(rays / kRaysPerThread, 1, std::max(1u, std::thread::hardware_concurrency()));
  const std::size_t part = (rays + threads - 1) / threads;
  std::vector<std::jthread> others;
  for (std::size_t t = 1; t < threads; ++t) {
    others.emplace_back([&, t] { work(t * part, std::min(part, rays - t * part)); });
  }
  work(0, std::min(part, rays));
}

void Measurement::take_embree(Result& result, const Turn& turn, const BareEmbree& embree, bool packets) {
  using Clock = std::chrono::steady_clock;
  for (const TrueScan& truth : turn.truths) {
    const glm::dmat3 world_from_sensor(truth.world_from_sensor);
    std::vector<glm::vec3> directions;
    for (const glm::dvec3& direction : truth.directions) directions.emplace_back(world_from_sensor * direction);
    std::vector<float> ranges_m(directions.size());
    const auto cast = [&](std::size_t first, std::size_t count) {
      const auto some = std::span(directions).subspan(first, count);
      const auto their = std::span(ranges_m).subspan(first, count);
      packets ? embree.cast_in_packets(some, their) : embree.cast_singly(some, their);
    };
    if (&truth == turn.truths.data()) share_out(directions.size(), cast);
    const auto start = Clock::now();
    share_out(directions.size(), cast);
    result.times_ms.push_back(std::chrono::duration<float, std::milli>(Clock::now() - start).count());
    add_errors(
        truth, ranges_m, {}, [](std::size_t) { return false; }, result.errors);
  }
}

std::vector<Result> Measurement::results() && {
  results_.push_back(std::move(embree_1_));
  results_.push_back(std::move(embree_16_));
  return std::move(results_);
}

/// Adds the variants to the scene, all switched off. Variants of `hybrid` that render nothing equal `raycast` and are
/// left out.
std::vector<Variant> mount(Simulation& simulation, const AccuracyScanner& scanner) {
  std::vector<Variant> variants = variants_of(scanner);
  simulation.execute(mount_xml(scanner, variants));
  for (const SensorInfo& sensor : simulation.sensors()) simulation.enable(sensor.name, false);
  std::set<std::string> promised_by_none;  // tolerances
  for (const Variant& variant : variants) {
    if (variant.method != "hybrid" || variant.resolution_px != scanner.resolutions_px.front()) continue;
    simulation.enable(variant.sensor, true);
    simulation.step();
    simulation.enable(variant.sensor, false);
    if (simulation.diagnostics().frame_plan().passes.empty()) promised_by_none.insert(variant.max_error_rel);
  }
  std::erase_if(variants, [&](const Variant& variant) { return promised_by_none.contains(variant.max_error_rel); });
  return variants;
}

}  // namespace

std::vector<Result> measure(Simulation& simulation, const AccuracyScene& scene, const AccuracyScanner& scanner,
                            int every) {
  Measurement measurement(simulation, scanner, mount(simulation, scanner));
  const int headings = scanner.lidar ? scene.lidar_headings : scene.planar_headings;
  const std::size_t stations = scanner.lidar ? scene.lidar_stations : scene.stations_m.size();
  for (std::size_t s = 0; s < stations; s += static_cast<std::size_t>(every)) {
    Turn turn{.station_m = scene.stations_m[s]};
    if (scanner.lidar) turn.station_m.z += scene.lidar_above_m;
    const BareEmbree embree(simulation.diagnostics().draw_list(), glm::translate(glm::dmat4(1.0), -turn.station_m));
    for (int h = 0; h < headings; h += every) {
      // The headings rotate a little further at each station, so that no beams of two stations are parallel.
      turn.headings_deg.push_back(360.0 * h / headings + 0.7310585786 * static_cast<double>(s + 1));
      if (turn.headings_deg.size() < kHeadingsPerTurn && h + every < headings) continue;
      measurement.take(turn, embree);
      turn.headings_deg.clear();
    }
  }
  return std::move(measurement).results();
}

}  // namespace simvis::bench
