#include "tests/support/element_scene.h"

#include <cmath>

namespace simvis::test {

void add_plate(GltfBuilder& file, const Plate& p, int material) {
  json& primitive = file.primitive({{"POSITION", file.accessor<float>("VEC3", {p.x, p.left, p.bottom,   //
                                                                               p.x, p.right, p.bottom,  //
                                                                               p.x, p.right, p.top,     //
                                                                               p.x, p.left, p.top})},
                                    {"TEXCOORD_0", file.accessor<float>("VEC2", {0, 1, 1, 1, 1, 0, 0, 0})}});
  primitive["indices"] = file.accessor<std::uint16_t>("SCALAR", {0, 1, 2, 0, 2, 3});
  primitive["material"] = material;
}

json painted(const std::string& name, const glm::vec4& color) {
  return {{"name", name},
          {"pbrMetallicRoughness", {{"baseColorFactor", {color.r, color.g, color.b, color.a}}, {"metallicFactor", 0}}}};
}

json unlit(const std::string& name, const glm::vec4& color) {
  json material = painted(name, color);
  material["extensions"]["KHR_materials_unlit"] = json::object();
  return material;
}

World::World(const std::vector<std::pair<std::string, GltfBuilder>>& files, const std::string& commands) {
  for (const auto& [name, file] : files) write_text(folder_ / name, file.text());
  simulation_.emplace(Simulation::from_string(commands, {}, folder_.path(), "s.xml"));
}

glm::dvec3 World::color(int x, int y) {
  simulation_->step();
  const Image& image = simulation_->color("CAM");
  const float* const pixel =
      &image.pixels[(static_cast<std::size_t>(y) * image.width + static_cast<std::size_t>(x)) * 4];
  return {pixel[0], pixel[1], pixel[2]};
}

glm::dvec3 World::color_with(std::string_view element, std::string_view parameter, double value) {
  simulation_->set(element, parameter, value);
  return color();
}

void check_color(const glm::dvec3& seen, const glm::dvec3& expected, double relative) {
  for (int c = 0; c < 3; ++c) {
    CAPTURE(c);
    CAPTURE(seen[c]);
    CAPTURE(expected[c]);
    CHECK(std::abs(seen[c] - expected[c]) <= relative * std::abs(expected[c]));
  }
}

}  // namespace simvis::test
