#include "import/urdf/urdf_leniency.h"

#include <algorithm>
#include <array>
#include <map>
#include <string_view>
#include <utility>

#include <simvis/attributes.h>

namespace simvis {
namespace {

// Half of the largest value of each colour, as sRGB.
constexpr const char* kGrey = "0.5 0.5 0.5 1";

std::string name_of(const pugi::xml_node& node) { return node.attribute("name").value(); }

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::ranges::find(words, word) != words.end();
}

// Whether the attribute is a list of `count` numbers of which one is 0 or less, or, for a scale, exactly 0.
template <std::size_t count>
bool has_no_size(const pugi::xml_node& node, const char* attribute, bool may_be_negative = false) {
  std::array<double, count> values{};
  if (!parse_numbers(node.attribute(attribute).value(), values)) return false;
  return std::ranges::any_of(values, [&](double value) { return may_be_negative ? value == 0 : value <= 0; });
}

// Text may stand before it.
pugi::xml_node first_element(const pugi::xml_node& parent) {
  return parent.find_child([](const pugi::xml_node& child) { return child.type() == pugi::node_element; });
}

class Mender {
 public:
  explicit Mender(const XmlText& text) : text_(text), robot_(text.document().child("robot")) {}

  UrdfMending run() {
    replace_commas();
    if (robot_ && name_of(robot_).empty()) add_name();
    collect_materials();
    for (const pugi::xml_node& link : robot_.children("link")) mend_link(link);
    for (const pugi::xml_node& joint : robot_.children("joint")) mend_joint(joint);
    for (const auto& [name, definition] : definitions_) add_missing_definition(name, definition);
    return std::move(mending_);
  }

 private:
  void warn(const pugi::xml_node& where, const pugi::xml_node& owner, const std::string& what) {
    mending_.warnings.push_back(to_string(text_.at(where)) + ": " + owner.name() + " " + in_quotes(name_of(owner)) +
                                " " + what);
  }

  static void remove(pugi::xml_node from, std::initializer_list<const char*> tags) {
    for (const char* tag : tags) {
      while (from.remove_child(tag)) {
      }
    }
  }

  static bool is_definition(const pugi::xml_node& material) {
    return material.child("color").attribute("rgba") || material.child("texture").attribute("filename");
  }

  static bool same_definition(const pugi::xml_node& a, const pugi::xml_node& b) {
    return std::string_view(a.child("color").attribute("rgba").value()) == b.child("color").attribute("rgba").value() &&
           std::string_view(a.child("texture").attribute("filename").value()) ==
               b.child("texture").attribute("filename").value();
  }

  void replace_commas() {
    bool is_first = true;
    for (const pugi::xml_node& node : nodes_below(robot_)) {
      for (const char* const name : {"xyz", "rpy", "size", "scale", "rgba"}) {
        pugi::xml_attribute numbers = node.attribute(name);
        if (std::string_view(numbers.value()).find(',') == std::string_view::npos) continue;
        if (std::exchange(is_first, false)) {
          mending_.warnings.push_back(to_string(text_.at(node)) + ": element <" + node.name() +
                                      "> has commas between the numbers of " + name +
                                      "; they are read as spaces, here and in others");
        }
        numbers.set_value(without_commas(numbers.value()).c_str());
      }
    }
  }

  static std::vector<pugi::xml_node> nodes_below(const pugi::xml_node& top) {
    std::vector<pugi::xml_node> nodes{top};
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const pugi::xml_node node = nodes[i];
      for (const pugi::xml_node& child : node.children()) nodes.push_back(child);
    }
    return nodes;
  }

  void add_name() {
    mending_.warnings.push_back(to_string(text_.at(robot_)) + ": the robot has no name");
    robot_.remove_attribute("name");
    robot_.append_attribute("name") = "robot";
  }

  void add_definition(const pugi::xml_node& material) {
    const auto [first, is_new] = definitions_.emplace(name_of(material), material);
    if (!is_new && !same_definition(first->second, material)) {
      warn(material, material, "is defined again in another way; the first definition counts");
    }
  }

  // Definitions of the robot come before those of visuals, as in liburdfdom.
  void collect_materials() {
    pugi::xml_node next;
    for (pugi::xml_node material = robot_.child("material"); material; material = next) {
      next = material.next_sibling("material");
      const bool repeated = definitions_.contains(name_of(material));
      if (is_definition(material)) add_definition(material);
      if (repeated || !is_definition(material)) robot_.remove_child(material);
    }
    for (const pugi::xml_node& link : robot_.children("link")) {
      for (const pugi::xml_node& visual : link.children("visual")) {
        const pugi::xml_node material = visual.child("material");
        if (is_definition(material) && !name_of(material).empty()) add_definition(material);
      }
    }
  }

  // A visual may use a material that a later visual defines; liburdfdom knows only those of earlier visuals.
  void add_missing_definition(const std::string& name, const pugi::xml_node& definition) {
    if (definition.parent() == robot_) return;
    if (!robot_.find_child_by_attribute("material", "name", name.c_str())) robot_.append_copy(definition);
  }

  void mend_link(pugi::xml_node link) {
    remove(link, {"inertial", "collision"});
    pugi::xml_node next;
    std::size_t kept = 0;  // visuals
    for (pugi::xml_node visual = link.child("visual"); visual; visual = next) {
      next = visual.next_sibling("visual");
      mend_scale(visual, link);
      const std::string reason = reason_to_leave_out(visual);
      if (!reason.empty()) {
        warn(visual, link, reason + "; the visual is left out");
        link.remove_child(visual);
      } else {
        mend_material(visual, link);
        pugi::xml_node shape = first_element(visual.child("geometry"));
        if (std::string_view(shape.name()) == "capsule") {
          mending_.capsules.emplace(name_of(link), kept);
          shape.set_name("cylinder");
        }
        ++kept;
      }
    }
  }

  void mend_scale(const pugi::xml_node& visual, const pugi::xml_node& link) {
    pugi::xml_attribute scale = visual.child("geometry").child("mesh").attribute("scale");
    double factor = 0;
    if (!scale || !parse_number(scale.value(), factor)) return;
    const std::string one = format_number(factor);
    warn(visual, link, "has a mesh whose scale is the one number " + one + "; it is taken for all three axes");
    scale.set_value((one + " " + one + " " + one).c_str());
  }

  static std::string reason_to_leave_out(const pugi::xml_node& visual) {
    const pugi::xml_node shape = first_element(visual.child("geometry"));
    const std::string_view kind = shape.name();
    if (kind.empty()) return "has a visual without a geometry";
    if (!is_one_of(kind, {"box", "cylinder", "capsule", "sphere", "mesh"})) {
      return "has a visual of kind " + in_quotes(kind) + ", expected box, cylinder, capsule, sphere or mesh";
    }
    const bool no_size = has_no_size<3>(shape, "size") || has_no_size<1>(shape, "radius") ||
                         has_no_size<1>(shape, "length") || has_no_size<3>(shape, "scale", true);
    if (no_size) return "has a " + std::string(kind) + " whose size is not above 0";
    if (kind == "mesh" && *shape.attribute("filename").value() == '\0') return "has a mesh without a filename";
    return "";
  }

  void mend_material(const pugi::xml_node& visual, const pugi::xml_node& link) {
    pugi::xml_node material = visual.child("material");
    if (!material) return;
    if (!material.attribute("name")) material.append_attribute("name") = "";
    const std::string name = name_of(material);
    if (name.empty() || definitions_.contains(name)) return;
    warn(material, link, "has the material " + in_quotes(name) + ", which is not defined; it is shown grey");
    pugi::xml_node grey = robot_.append_child("material");
    grey.append_attribute("name") = name.c_str();
    grey.append_child("color").append_attribute("rgba") = kGrey;
    definitions_.emplace(name, grey);
  }

  void mend_joint(pugi::xml_node joint) {
    remove(joint, {"dynamics", "safety_controller", "calibration"});
    const std::string_view type = joint.attribute("type").value();
    if (type == "fixed" && joint.child("mimic")) {
      warn(joint.child("mimic"), joint, "is fixed and mimics another one; the mimic is ignored");
      remove(joint, {"mimic"});
    }
    const char* const leader = joint.child("mimic").attribute("joint").value();
    if (*leader != '\0' && !robot_.find_child_by_attribute("joint", "name", leader)) {
      warn(joint.child("mimic"), joint,
           "mimics joint " + in_quotes(leader) + ", which is not there; it moves by itself");
      remove(joint, {"mimic"});
    }
    const bool needs_limits = is_one_of(type, {"revolute", "prismatic"});
    if (needs_limits && !joint.child("limit")) {
      warn(joint, joint, "has no limits; it is left open");
      joint.append_child("limit");
      mending_.joints_without_limits.insert(name_of(joint));
    }
    pugi::xml_node limit = joint.child("limit");
    for (const char* unread : {"effort", "velocity"}) {
      if (!limit) continue;
      if (!limit.attribute(unread)) limit.append_attribute(unread);
      limit.attribute(unread) = "0";
    }
    double lower = 0, upper = 0;
    parse_number(limit.attribute("lower").value(), lower);
    parse_number(limit.attribute("upper").value(), upper);
    if (needs_limits && lower > upper) {
      warn(limit, joint, "has a lower limit above its upper one; it is left open");
      mending_.joints_without_limits.insert(name_of(joint));
    }
  }

  const XmlText& text_;
  pugi::xml_node robot_;
  std::map<std::string, pugi::xml_node> definitions_;
  UrdfMending mending_;
};

}  // namespace

std::string without_commas(std::string_view numbers) {
  std::string text(numbers);
  std::ranges::replace(text, ',', ' ');
  return text;
}

UrdfMending mend_urdf(const XmlText& text) { return Mender(text).run(); }

}  // namespace simvis
