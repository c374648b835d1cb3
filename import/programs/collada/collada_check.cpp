#include "import/programs/collada/collada_check.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/attributes.h>

namespace simvis {
namespace {

constexpr std::string_view kPrimitives[] = {"lines",     "linestrips", "polygons", "polylist",
                                            "triangles", "trifans",    "tristrips"};

class ColladaCheck : public pugi::xml_tree_walker {
 public:
  explicit ColladaCheck(const XmlText& text) : text_(text) {}

  void run() {
    pugi::xml_node document = text_.document();
    document.traverse(*this);
    check_scene(document.child("COLLADA"));
    check_circles();
    for (const pugi::xml_node& accessor : accessors_) check_accessor(accessor);
  }

  bool for_each(pugi::xml_node& node) override {
    const std::string_view tag = node.name();
    if (is_in_controller(node)) return true;
    if (tag.ends_with("_array")) arrays_[node.attribute("id").value()] = node;
    if (tag == "accessor") accessors_.push_back(node);
    if (tag == "node" && node.attribute("id")) nodes_.emplace(node.attribute("id").value(), node);
    if (is_primitives(node)) check_primitives(node);
    if ((tag == "p" || tag == "vcount") && is_primitives(node.parent())) check_indices(node);
    if (node.parent().name() == std::string_view("ph")) check_indices(node);
    return true;
  }

 private:
  // What deforms a mesh is not read: the mesh has its rest pose, see reduce_to_shapes().
  static bool is_in_controller(pugi::xml_node node) {
    while (node && node.name() != std::string_view("library_controllers")) node = node.parent();
    return static_cast<bool>(node);
  }

  double whole_number(const pugi::xml_node& node, const char* name, const char* otherwise, double largest) const {
    const char* const written = node.attribute(name).as_string(otherwise);
    const char* const text = *written == '\0' ? otherwise : written;  // offset="" is written by converters
    double value = 0;
    if (!parse_number(text, value) || value != std::floor(value) || value < 0 || value > largest) {
      fail_at(text_.at(node), "attribute " + in_quotes(name) + ": " + in_quotes(text) +
                                  " is not allowed, expected a whole number from 0 to " + format_number(largest));
    }
    return value;
  }

  // Assimp says "File came out empty" to such a file.
  void check_scene(const pugi::xml_node& collada) const {
    if (!collada) fail_at({.file = text_.source().file()}, "has no element COLLADA");
    const pugi::xml_node instance = collada.child("scene").child("instance_visual_scene");
    if (!instance) fail_at(text_.at(collada), "has no <scene> with <instance_visual_scene>, so nothing is drawn");
    const std::string_view url = instance.attribute("url").value();
    for (const pugi::xml_node& library : collada.children("library_visual_scenes")) {
      for (const pugi::xml_node& scene : library.children("visual_scene")) {
        if (url.starts_with('#') && url.substr(1) == scene.attribute("id").value()) return;
      }
    }
    fail_at(text_.at(instance), "there is no visual scene " + in_quotes(url));
  }

  // Nodes contain others as children and by <instance_node>. Assimp follows a circle until its stack is full.
  void check_circles() const {
    enum class State { open, done };
    std::map<pugi::xml_node, State> states;
    for (const auto& [id, start] : nodes_) {
      std::vector<pugi::xml_node> stack{start};
      while (!stack.empty()) {
        const pugi::xml_node node = stack.back();
        const auto [state, is_new] = states.try_emplace(node, State::open);
        if (!is_new) {
          state->second = State::done;
          stack.pop_back();
          continue;
        }
        for (const pugi::xml_node& child : node.children()) {
          const pugi::xml_node next = contained_node(child);
          if (!next) continue;
          const auto known = states.find(next);
          if (known == states.end()) stack.push_back(next);
          if (known == states.end() || known->second == State::done) continue;
          fail_at(text_.at(child), "node " + in_quotes(next.attribute("id").value()) + " is within itself: a circle");
        }
      }
    }
  }

  // The node that a child of a node is or stands for; null: none.
  pugi::xml_node contained_node(const pugi::xml_node& child) const {
    const std::string_view tag = child.name(), url = child.attribute("url").value();
    if (tag == "node") return child;
    if (tag != "instance_node" || !url.starts_with('#')) return {};
    const auto named = nodes_.find(url.substr(1));
    return named == nodes_.end() ? pugi::xml_node() : named->second;
  }

  static bool is_primitives(const pugi::xml_node& node) {
    return std::ranges::find(kPrimitives, std::string_view(node.name())) != std::end(kPrimitives);
  }

  // Other characters than digits send Assimp into an endless loop.
  void check_indices(const pugi::xml_node& node) const {
    const std::string_view digits = node.child_value();
    const std::size_t wrong = digits.find_first_not_of("0123456789 \t\r\n");
    if (wrong == std::string_view::npos) return;
    fail_at(text_.at(node), std::string(node.name()) + " holds " + in_quotes(digits.substr(wrong, 1)) +
                                ", expected whole numbers from 0 up");
  }

  void check_accessor(const pugi::xml_node& accessor) const {
    constexpr double kMax = 4294967295;
    const std::string_view source = accessor.attribute("source").value();
    const auto array = source.starts_with('#') ? arrays_.find(source.substr(1)) : arrays_.end();
    if (array == arrays_.end()) {
      fail_at(text_.at(accessor), "accessor of " + in_quotes(source) + ", expected the id of an array of the file");
    }
    const double has = whole_number(array->second, "count", "", kMax);
    const double stride = whole_number(accessor, "stride", "1", kMax);
    const double count = whole_number(accessor, "count", "", kMax);
    const double offset = whole_number(accessor, "offset", "0", kMax);
    const auto parameters = accessor.children("param");
    const auto used = static_cast<double>(std::distance(parameters.begin(), parameters.end()));
    if (used > stride || offset + count * stride > has) {
      fail_at(text_.at(accessor), "accessor reaches beyond its array of " + format_number(has) + " values");
    }
  }

  void check_primitives(const pugi::xml_node& node) const {
    constexpr double kMaxInputs = 63;
    int vertices = 0;
    for (const pugi::xml_node& input : node.children("input")) {
      whole_number(input, "offset", "", kMaxInputs);
      whole_number(input, "set", "0", kMaxInputs);
      vertices += input.attribute("semantic").value() == std::string_view("VERTEX");
    }
    if (vertices != 1 && node.child("p")) {
      fail_at(text_.at(node), std::string(node.name()) + " has " + std::to_string(vertices) +
                                  " inputs of the semantic VERTEX, expected 1");
    }
  }

  const XmlText& text_;
  std::map<std::string, pugi::xml_node, std::less<>> arrays_;
  std::vector<pugi::xml_node> accessors_;
  std::map<std::string, pugi::xml_node, std::less<>> nodes_;
};

}  // namespace

void check_collada(const XmlText& text) { ColladaCheck(text).run(); }

}  // namespace simvis
