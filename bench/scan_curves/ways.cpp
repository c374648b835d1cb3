#include "bench/scan_curves/ways.h"

#include <cstdlib>
#include <memory>

#include "simvis/report/scan_variant.h"

namespace simvis::bench {

namespace {

struct Method {
  const char *name, *max_error_rel;
};
constexpr Method kMethods[] = {{"nearest", ""}, {"planar", ""},   {"hybrid", "1e-4"}, {"hybrid", "1e-6"},
                               {"raycast", ""}, {"auto", "1e-4"}, {"auto", "1e-6"}};
// Timed sets per turn, after one that is not timed: the first frame of a method creates data that the frames of the
// other methods did not need.
constexpr int kSetsPerTurn = 5;
// Several turns are needed for a median; for a slow method one set is enough.
constexpr std::size_t kMinSets = 15;
constexpr double kLong = 10;  // times the method's share of the time

std::string variant_name(const std::string& scanner, const Method& method) {
  std::string name = scanner + "_" + method.name + method.max_error_rel;
  return name;
}

std::vector<float> all_ranges(const Simulation& simulation, const std::vector<std::string>& sensors) {
  std::vector<float> all;
  for (const std::string& sensor : sensors) {
    const std::vector<float>& ranges = simulation.scan(sensor).range_m;
    all.insert(all.end(), ranges.begin(), ranges.end());
  }
  return all;
}

}  // namespace

std::vector<Way> simvis_ways(Simulation& simulation, const std::vector<std::string>& scanners,
                             const std::function<void(int frame)>& move) {
  for (const SensorInfo& sensor : simulation.sensors()) simulation.enable(sensor.name, false);
  const auto on = std::make_shared<std::vector<std::string>>();
  std::vector<Way> ways;
  for (const Method& method : kMethods) {
    std::vector<std::string> names;
    for (const std::string& scanner : scanners) {
      ScanVariant variant{.method = method.name, .resolution_px = {}, .max_error_rel = {}};
      if (*method.max_error_rel != 0) variant.max_error_rel = std::strtod(method.max_error_rel, nullptr);
      names.push_back(variant_name(scanner, method));
      simulation.add_variant(scanner, with_variant(simulation.diagnostics().command(scanner), variant, names.back()));
      simulation.enable(names.back(), false);
    }
    ways.push_back({.name = method.name,
                    .max_error_rel = method.max_error_rel,
                    .begin_turn =
                        [&simulation, on, names] {
                          for (const std::string& name : *on) simulation.enable(name, false);
                          for (const std::string& name : names) simulation.enable(name, true);
                          *on = names;
                        },
                    .move = move,
                    .set = [&simulation] { simulation.step(); },
                    .ranges_m = [&simulation, names] { return all_ranges(simulation, names); }});
  }
  return ways;
}

void time_ways(std::vector<Way>& ways, double seconds) {
  const double share_ms = 1e3 * seconds / static_cast<double>(ways.size());
  std::vector<double> spent_ms(ways.size());
  int frame = 0;
  const auto move_on = [&](const Way& way) {
    ++frame;
    if (way.move) way.move(frame);
  };
  const auto is_done = [&](std::size_t i) {
    const std::size_t sets = ways[i].took.size();
    return spent_ms[i] >= share_ms && (sets >= kMinSets || (sets > 0 && spent_ms[i] >= kLong * share_ms));
  };
  for (bool any = true; any;) {
    any = false;
    for (std::size_t i = 0; i < ways.size(); ++i) {
      if (is_done(i)) continue;
      any = true;
      Way& way = ways[i];
      way.begin_turn();
      move_on(way);
      spent_ms[i] += time_work(way.set).wall_ms;
      for (int set = 0; set < kSetsPerTurn && !is_done(i); ++set) {
        move_on(way);
        way.took.push_back(time_work(way.set));
        spent_ms[i] += way.took.back().wall_ms;
      }
    }
  }
}

}  // namespace simvis::bench
