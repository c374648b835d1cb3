// Laser scanners with method="auto" that choose by given costs.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <simvis/cost_model.h>
#include <simvis/device.h>
#include <simvis/simulation.h>
#include "engine/render/renderer.h"
#include "sensors/laser_scanner/laser_scanner.h"
#include "tests/support/temporary_folder.h"

namespace simvis::test {

/// The laser scanners of the marvin scene.
inline constexpr const char* kMarvinScanners[] = {"FRONT_SCANNER", "REAR_SCANNER", "TILT_SCANNER"};

/// Costs with which rendering is almost free and casting is expensive, or the other way round.
CostModel made_up_costs(bool cheap_to_render);

/// The device of these tests and what measures with it.
struct Machine {
  Device device;
  Renderer renderer{device};
  std::unique_ptr<RayCaster> caster = make_ray_caster(device);
};

Machine& machine();

/// A cache folder that holds these costs for the device.
struct CostsFolder {
  explicit CostsFolder(const CostModel& cost);
  TemporaryFolder folder;
  std::filesystem::path file;
};

/// A scanner "S" that chooses by made_up_costs().
LaserScanner make_scanner(const LaserScannerDesc& desc, bool cheap_to_render);

/// Takes one scan.
void measure(LaserScanner& scanner, const DrawList& list, const glm::dmat4& world_from_sensor = glm::dmat4(1.0));

/// The value of a note as text, "" if there is none.
std::string noted(const SensorReport& report, std::string_view name);

/// The marvin scene with its laser scanners only, which get these attributes.
Simulation marvin_scanners(const std::filesystem::path& cache,
                           const std::vector<std::pair<std::string, std::string>>& attributes);

SensorInfo sensor(const Simulation& simulation, std::string_view name);

/// The method that a scanner chose, such as "hybrid 512".
std::string chosen(const Simulation& simulation, std::string_view name);

}  // namespace simvis::test
