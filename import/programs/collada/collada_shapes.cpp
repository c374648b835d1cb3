#include "import/programs/collada/collada_shapes.h"

#include <algorithm>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace simvis {
namespace {

constexpr std::string_view kShown[] = {"asset",
                                       "library_effects",
                                       "library_geometries",
                                       "library_images",
                                       "library_materials",
                                       "library_nodes",
                                       "library_visual_scenes",
                                       "scene"};
constexpr std::string_view kNotShown[] = {"extra", "instance_camera", "instance_light", "instance_physics_scene",
                                          "instance_kinematics_scene"};

bool is_one_of(std::span<const std::string_view> names, const pugi::xml_node& node) {
  return std::ranges::find(names, std::string_view(node.name())) != names.end();
}

// Finds all nodes with these names, before any of them is changed.
std::vector<pugi::xml_node> find_all(pugi::xml_node root, std::span<const std::string_view> names) {
  struct Walker : pugi::xml_tree_walker {
    bool for_each(pugi::xml_node& node) override {
      if (is_one_of(names, node)) found.push_back(node);
      return true;
    }
    std::span<const std::string_view> names;
    std::vector<pugi::xml_node> found;
  } walker;
  walker.names = names;
  root.traverse(walker);
  return walker.found;
}

// Maps the "#id" of each controller to its source, the "#id" of a mesh or of another controller.
std::map<std::string, std::string> sources_of(const pugi::xml_node& collada) {
  std::map<std::string, std::string> sources;
  for (const pugi::xml_node& controller : collada.child("library_controllers").children("controller")) {
    const pugi::xml_node skin = controller.child("skin"), morph = controller.child("morph");
    sources[std::string("#") + controller.attribute("id").value()] = (skin ? skin : morph).attribute("source").value();
  }
  return sources;
}

}  // namespace

ColladaShapes reduce_to_shapes(XmlText& text) {
  ColladaShapes shapes;
  pugi::xml_node collada = text.document().child("COLLADA");
  const std::map<std::string, std::string> sources = sources_of(collada);
  shapes.had_animations = !collada.child("library_animations").empty();

  constexpr std::string_view kController[] = {"instance_controller"};
  for (pugi::xml_node instance : find_all(collada, kController)) {
    shapes.had_skins = true;
    std::string url = instance.attribute("url").value();
    for (std::size_t steps = 0; steps < sources.size(); ++steps) {
      const auto deformed = sources.find(url);
      if (deformed == sources.end()) break;
      url = deformed->second;
    }
    instance.set_name("instance_geometry");
    instance.attribute("url").set_value(url.c_str());
    while (instance.remove_child("skeleton")) {
    }
  }
  // In reverse order, so that nested nodes are removed before the nodes that contain them.
  std::vector<pugi::xml_node> not_shown = find_all(collada, kNotShown);
  for (auto node = not_shown.rbegin(); node != not_shown.rend(); ++node) node->parent().remove_child(*node);
  for (pugi::xml_node library = collada.first_child(); library;) {
    const pugi::xml_node next = library.next_sibling();
    if (!is_one_of(kShown, library)) collada.remove_child(library);
    library = next;
  }
  return shapes;
}

}  // namespace simvis
