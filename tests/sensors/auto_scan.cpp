#include "tests/sensors/auto_scan.h"

#include "tests/support/tested_build.h"

namespace simvis::test {

CostModel made_up_costs(bool cheap_to_render) {
  CostModel cost;
  for (std::size_t i = 0; i < kCostTerms; ++i) {
    const bool casting = i >= static_cast<std::size_t>(CostTerm::cast);
    cost.of[i] = casting == cheap_to_render ? 1000 : 0.001;
  }
  return cost;
}

Machine& machine() {
  static Machine machine;
  return machine;
}

CostsFolder::CostsFolder(const CostModel& cost) : file(cost_model_file(machine().device, folder.path(), version())) {
  save_cost_model(file, cost);
}

LaserScanner make_scanner(const LaserScannerDesc& desc, bool cheap_to_render) {
  const CostModel cost = made_up_costs(cheap_to_render);
  LaserScanner scanner("S", desc);
  scanner.use_cost_model([&]() -> const CostModel& { return cost; });
  return scanner;
}

void measure(LaserScanner& scanner, const DrawList& list, const glm::dmat4& world_from_sensor) {
  FramePlan plan;
  scanner.plan(world_from_sensor, list, plan);
  scanner.collect({}, plan, machine().renderer.render(list, plan));
  machine().caster->set_world(list);
  scanner.cast(*machine().caster);
}

std::string noted(const SensorReport& report, std::string_view name) {
  for (const SensorNote& note : report.notes) {
    if (note.name != name) continue;
    if (const auto* text = std::get_if<std::string>(&note.value)) return *text;
    if (const auto* whole = std::get_if<std::uint64_t>(&note.value)) return std::to_string(*whole);
    return std::to_string(std::get<double>(note.value));
  }
  return "";
}

Simulation marvin_scanners(const std::filesystem::path& cache,
                           const std::vector<std::pair<std::string, std::string>>& attributes) {
  SimulationDesc desc;
  desc.device.cache_dir = cache.string();
  for (const auto& [name, value] : attributes) desc.overrides.push_back({"laser_scanner", name, value, "this test"});
  Simulation simulation = Simulation::load(std::filesystem::path(SIMVIS_SOURCE_DIR) / "scenes/marvin/marvin.xml", desc);
  for (const SensorInfo& sensor : simulation.sensors()) simulation.enable(sensor.name, sensor.type == "laser_scanner");
  return simulation;
}

SensorInfo sensor(const Simulation& simulation, std::string_view name) {
  for (const SensorInfo& each : simulation.sensors()) {
    if (each.name == name) return each;
  }
  return {};
}

std::string chosen(const Simulation& simulation, std::string_view name) {
  return noted(sensor(simulation, name).report, "chosen");
}

}  // namespace simvis::test
