// Writes what a camera sees into files that other renderers can read.
#pragma once

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include <simvis/simulation.h>

namespace simvis::bench {

/// Writes NAME.json and NAME.bin into the folder: the triangles of the last frame, each item as float32 positions in
/// the world's frame and uint32 indices, with its colour; the lights; and the pose and size of the first view.
inline void export_frame(const Simulation& simulation, const std::filesystem::path& folder, const std::string& name) {
  const DrawList& list = simulation.diagnostics().draw_list();
  const View& view = simulation.diagnostics().frame_plan().passes.at(0).views.at(0);
  std::ofstream data(folder / (name + ".bin"), std::ios::binary);
  nlohmann::json items = nlohmann::json::array(), lights = nlohmann::json::array();
  const auto array_of = [](const auto& v, int count) {
    nlohmann::json numbers = nlohmann::json::array();
    for (int i = 0; i < count; ++i) numbers.push_back(v[i]);
    return numbers;
  };
  for (const DrawItem& item : list.items) {
    const Mesh& mesh = *list.meshes[item.mesh];
    if (mesh.topology != Topology::triangles || mesh.indices.empty()) continue;
    for (const glm::vec3& p : mesh.positions) {
      const glm::vec3 world(list.world_from_node[item.transform] * glm::dvec4(p, 1));
      data.write(reinterpret_cast<const char*>(&world), sizeof world);
    }
    data.write(reinterpret_cast<const char*>(mesh.indices.data()),
               static_cast<std::streamsize>(mesh.indices.size() * sizeof mesh.indices[0]));
    items.push_back({{"vertices", mesh.positions.size()},
                     {"indices", mesh.indices.size()},
                     {"color", array_of(list.materials[item.material]->base_color, 4)}});
  }
  for (const LightItem& item : list.lights) {
    const glm::dmat4& place = list.world_from_node[item.transform];
    lights.push_back({{"kind", static_cast<int>(item.light.kind)},
                      {"position", array_of(place[3], 3)},
                      {"direction", array_of(glm::dmat3(place) * item.light.direction, 3)}});
  }
  const glm::dmat4 pose = glm::inverse(view.view_from_world);
  const nlohmann::json all{{"items", items},
                           {"lights", lights},
                           {"eye", array_of(pose[3], 3)},
                           {"right", array_of(pose[0], 3)},
                           {"down", array_of(pose[1], 3)},
                           {"forward", array_of(pose[2], 3)},
                           {"width", view.width_px},
                           {"height", view.height_px},
                           {"fy_px", view.pinhole.fy_px}};
  std::ofstream text(folder / (name + ".json"));
  text << all;
  if (!text.flush() || !data.flush()) throw std::runtime_error("cannot write " + (folder / name).string());
}

}  // namespace simvis::bench
