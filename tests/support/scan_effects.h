// Effects of a laser scanner by themselves, and beams traced with them through draw lists made by hand.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/ray_caster.h>
#include <simvis/scan_effect.h>
#include <simvis/sensor.h>
#include "tests/support/ray_casting.h"

namespace simvis {

/// Those that a scanner with these attributes has; of one name, or all.
inline std::vector<ChosenScanEffect> effects_of(const std::string& attributes, std::string_view name = {},
                                                const std::string& sensor = "S", std::uint64_t seed = 0) {
  const Command command =
      parse_commands("<sensor type='laser_scanner' name='S' insert_at='ROOT' " + attributes + "/>", "s.xml", "").at(0);
  const AttributeValues values(command, all_attributes(*find_sensor_type("laser_scanner")), kSensorCommonAttributes);
  std::vector<ChosenScanEffect> effects = scan_effects({.attributes = values,
                                                        .rings = 1,
                                                        .beams = 1,
                                                        .range_max_m = values.number("range_max"),
                                                        .seed = seed,
                                                        .sensor = sensor});
  if (!name.empty()) std::erase_if(effects, [&](const ChosenScanEffect& each) { return each.type->name != name; });
  return effects;
}

/// Keeps what came back along each beam.
class EchoLog : public ScanEffect {
 public:
  void receive(const ScanContext&, std::uint32_t beam, std::vector<Echo>& echoes) const override {
    log_->resize(std::max<std::size_t>(log_->size(), beam + 1));
    (*log_)[beam] = echoes;
  }
  const std::vector<std::vector<Echo>>& log() const { return *log_; }

 private:
  std::unique_ptr<std::vector<std::vector<Echo>>> log_ = std::make_unique<std::vector<std::vector<Echo>>>();
};

/// The echoes of each beam from the world's origin, by range.
inline std::vector<std::vector<Echo>> echoes_of(const DrawList& list, const std::vector<glm::dvec3>& directions,
                                                std::vector<ChosenScanEffect> effects, RayCaster& caster) {
  const auto log = std::make_shared<EchoLog>();
  effects.push_back({nullptr, log});
  ScanContext moment{.time = {}, .before = {}, .rings = 1, .beams = static_cast<std::uint32_t>(directions.size())};
  moment.range_max_m = 1000;
  moment.medium = list.medium;
  caster.set_world(list);
  TracedScan(directions, effects).trace(moment, list, caster);
  return log->log();
}

/// A parallelogram: two triangles about `middle`, reaching over it by the half edges.
inline Mesh plate_mesh(const glm::dvec3& half, const glm::dvec3& other_half) {
  Mesh mesh;
  for (const auto& [a, b] : {std::pair(-1, -1), std::pair(1, -1), std::pair(1, 1), std::pair(-1, 1)}) {
    mesh.positions.emplace_back(static_cast<double>(a) * half + static_cast<double>(b) * other_half);
  }
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

/// Adds a mesh of this material.
inline void add_item(DrawList& list, Mesh mesh, const glm::dmat4& world_from_mesh, const Material& material) {
  add_item(list, std::move(mesh), world_from_mesh);
  list.items.back().material = static_cast<std::uint32_t>(list.materials.size());
  list.materials.push_back(std::make_shared<Material>(material));
  list.material_revision.push_back(0);
}

}  // namespace simvis
