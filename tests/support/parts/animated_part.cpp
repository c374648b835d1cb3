#include "tests/support/parts/animated_part.h"

#include <cmath>
#include <limits>
#include <utility>
#include "scenegraph/part_animation.h"

namespace simvis::test {

json& add_clip(GltfBuilder& builder, const std::string& name) {
  builder.append("animations", {{"name", name}, {"channels", json::array()}, {"samplers", json::array()}});
  return builder.root["animations"].back();
}

void add_channel(GltfBuilder& builder, int node, const char* path, const char* interpolation, int input, int output,
                 std::size_t clip) {
  json& animation = builder.root["animations"][clip];
  const std::size_t sampler = animation["samplers"].size();
  animation["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", interpolation}});
  animation["channels"].push_back({{"sampler", sampler}, {"target", {{"node", node}, {"path", path}}}});
}

GltfBuilder bending_strip() {
  GltfBuilder builder;
  json& primitive = builder.primitive(
      {{"POSITION", builder.accessor<float>("VEC3", {3, -2, 0, 3, 2, 0, 3, -2, 1, 3, 2, 1, 3, -2, 2, 3, 2, 2})},
       {"NORMAL", builder.accessor<float>("VEC3", {-1, 0, 0, -1, 0, 0, -1, 0, 0, -1, 0, 0, -1, 0, 0, -1, 0, 0})},
       {"JOINTS_0", builder.accessor<std::uint8_t>("VEC4", {0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0,  //
                                                            0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0})},
       {"WEIGHTS_0", builder.accessor<float>("VEC4", {1,    0,    0, 0, 1, 0, 0, 0, 0.5f, 0.5f, 0, 0,  //
                                                      0.5f, 0.5f, 0, 0, 1, 0, 0, 0, 1,    0,    0, 0})}});
  primitive["indices"] = builder.accessor<std::uint16_t>("SCALAR", {0, 2, 1, 1, 2, 3, 2, 4, 3, 3, 4, 5});
  primitive["material"] = 0;
  builder.append("materials", {{"doubleSided", true}});
  builder.root["nodes"][0].update({{"skin", 0}, {"translation", {50, 0, 0}}});  // which does not count
  builder.append("nodes", {{"translation", {3, 0, 0}}, {"children", {2}}});
  builder.append("nodes", {{"translation", {0, 0, 1}}});
  builder.append("skins", {{"joints", {1, 2}},
                           {"inverseBindMatrices",
                            builder.accessor<float>("MAT4", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -3, 0, 0,  1,
                                                             1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -3, 0, -1, 1})}});
  builder.root["scenes"] = {{{"nodes", {0, 1}}}};
  add_clip(builder, "Bend");
  std::vector<float> turns;
  for (const double angle : {0.0, M_PI / 4, M_PI / 2}) {
    turns.insert(turns.end(), {0, static_cast<float>(std::sin(angle / 2)), 0, static_cast<float>(std::cos(angle / 2))});
  }
  add_channel(builder, 2, "rotation", "LINEAR", builder.accessor<float>("SCALAR", {0, 1, 2}),
              builder.accessor<float>("VEC4", turns));
  return builder;
}

PlayedPart::PlayedPart(const GltfBuilder& builder, const std::string& attributes, const std::string& more) {
  write_text(folder_ / "part.gltf", builder.text());
  start(folder_ / "part.gltf", attributes, more);
}

PlayedPart::PlayedPart(const std::filesystem::path& file, const std::string& attributes) {
  start(file, attributes, "");
}

const DrawList& PlayedPart::at(double time_s) {
  built_.parameters.set(built_.parameters.index("WALK", "time"), time_s);
  for (const std::size_t i : built_.parameters.drain_changed_elements()) {
    built_.elements[i]->update(built_.parameters.values().subspan(built_.parameters.elements()[i].first_value));
  }
  return flattener_->update();
}

glm::dmat4 PlayedPart::matrix_at(double time_s, std::size_t item) {
  const DrawList& list = at(time_s);
  return list.world_from_node[list.items.at(item).transform];
}

const Mesh& PlayedPart::mesh_at(double time_s, std::size_t item) {
  const DrawList& list = at(time_s);
  return *list.meshes[list.items.at(item).mesh];
}

double PlayedPart::duration_s(std::size_t clip) {
  return built_.scene.own_part("P", {}).content.animations->clips.at(clip).duration_s;
}

void PlayedPart::start(const std::filesystem::path& file, const std::string& attributes, const std::string& more) {
  const std::string xml = "<part file='" + file.string() + "' name='P' insert_at='ROOT' up='z'/>" + more +
                          "<element type='animation' name='WALK' insert_at='ROOT' part='P' " + attributes + "/>";
  built_ = build_scene(parse_commands(xml, "s.xml", folder_.path()));
  flattener_.emplace(built_.scene.root());
}

}  // namespace simvis::test
