#include "bench/scan_curves/methods.h"

#include <cstdlib>
#include <memory>

#include "program/report/scan_variant.h"

namespace simvis::bench {

namespace {

struct Setting {
  const char *method, *max_error_rel;
};
constexpr Setting kSettings[] = {{"nearest", ""}, {"planar", ""},   {"hybrid", "1e-4"}, {"hybrid", "1e-6"},
                                 {"raycast", ""}, {"auto", "1e-4"}, {"auto", "1e-6"}};
// Timed sets per turn, after one that is not timed: the first frame of a method creates data that the frames of the
// other methods did not need.
constexpr int kSetsPerTurn = 5;
// Several turns are needed for a median; for a slow method one set is enough.
constexpr std::size_t kMinSets = 15;
constexpr double kLong = 10;  // times the method's share of the time

std::string variant_name(const std::string& scanner, const Setting& setting) {
  std::string name = scanner + "_" + setting.method + setting.max_error_rel;
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

std::vector<Method> simvis_methods(Simulation& simulation, const std::vector<std::string>& scanners,
                                   const std::function<void(int frame)>& move) {
  for (const SensorInfo& sensor : simulation.sensors()) simulation.enable(sensor.name, false);
  const auto on = std::make_shared<std::vector<std::string>>();
  std::vector<Method> methods;
  for (const Setting& setting : kSettings) {
    std::vector<std::string> names;
    for (const std::string& scanner : scanners) {
      ScanVariant variant{.method = setting.method, .resolution_px = {}, .max_error_rel = {}};
      if (*setting.max_error_rel != 0) variant.max_error_rel = std::strtod(setting.max_error_rel, nullptr);
      names.push_back(variant_name(scanner, setting));
      simulation.add_variant(scanner, with_variant(simulation.diagnostics().command(scanner), variant, names.back()));
      simulation.enable(names.back(), false);
    }
    methods.push_back({.name = setting.method,
                       .max_error_rel = setting.max_error_rel,
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
  return methods;
}

void time_methods(std::vector<Method>& methods, double seconds) {
  const double share_ms = 1e3 * seconds / static_cast<double>(methods.size());
  std::vector<double> spent_ms(methods.size());
  int frame = 0;
  const auto move_on = [&](const Method& method) {
    ++frame;
    if (method.move) method.move(frame);
  };
  const auto is_done = [&](std::size_t i) {
    const std::size_t sets = methods[i].took.size();
    return spent_ms[i] >= share_ms && (sets >= kMinSets || (sets > 0 && spent_ms[i] >= kLong * share_ms));
  };
  for (bool any = true; any;) {
    any = false;
    for (std::size_t i = 0; i < methods.size(); ++i) {
      if (is_done(i)) continue;
      any = true;
      Method& method = methods[i];
      method.begin_turn();
      move_on(method);
      spent_ms[i] += time_work(method.set).wall_ms;
      for (int set = 0; set < kSetsPerTurn && !is_done(i); ++set) {
        move_on(method);
        method.took.push_back(time_work(method.set));
        spent_ms[i] += method.took.back().wall_ms;
      }
    }
  }
}

}  // namespace simvis::bench
