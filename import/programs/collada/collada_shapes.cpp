#include "import/programs/collada/collada_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <map>
#include <numbers>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/location.h>

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

// A vector of three numbers, with a length of 1.
glm::dvec3 unit_axis(const XmlText& text, const pugi::xml_node& skew, const double* numbers) {
  const glm::dvec3 axis(numbers[0], numbers[1], numbers[2]);
  if (!(glm::length(axis) > 0)) fail_at(text.at(skew), "skew has an axis without length");
  return glm::normalize(axis);
}

// As RiSkew of the RenderMan Interface: points move along the second axis, so that the first one turns by the angle.
glm::dmat4 skew_matrix(const XmlText& text, const pugi::xml_node& skew) {
  std::array<double, 7> numbers{};
  if (!parse_numbers(skew.child_value(), numbers)) {
    fail_at(text.at(skew), "skew has " + in_quotes(skew.child_value()) + ", expected an angle and two axes");
  }
  const glm::dvec3 turned = unit_axis(text, skew, &numbers[1]), along = unit_axis(text, skew, &numbers[4]);
  const double angle = glm::radians(numbers[0]), between = std::acos(std::clamp(glm::dot(turned, along), -1.0, 1.0));
  if (!(angle < between && between - angle < std::numbers::pi)) {
    fail_at(text.at(skew), "skew turns an axis by " + format_number(numbers[0]) +
                               " degrees, expected less than the angle between its axes");
  }
  const glm::dvec3 across = glm::normalize(turned - along * glm::dot(turned, along));
  const double shift = 1 / std::tan(between - angle) - 1 / std::tan(between);
  glm::dmat4 matrix(1);
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) matrix[column][row] += shift * across[column] * along[row];
  }
  return matrix;
}

}  // namespace

void replace_skews(XmlText& text) {
  constexpr std::string_view kSkew[] = {"skew"};
  for (pugi::xml_node skew : find_all(text.document().child("COLLADA"), kSkew)) {
    const glm::dmat4 matrix = skew_matrix(text, skew);
    std::string numbers;
    for (int row = 0; row < 4; ++row) {
      for (int column = 0; column < 4; ++column) numbers += format_number(matrix[column][row]) + " ";
    }
    skew.set_name("matrix");
    skew.text() = numbers.c_str();
  }
}

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
