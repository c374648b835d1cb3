#include "import/programs/collada/collada_references.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/location.h>
#include "engine/base/words.h"
#include "import/programs/repeated_warning.h"

namespace simvis {
namespace {

// The elements that references name, by id.
using Elements = std::map<std::string, pugi::xml_node, std::less<>>;

struct Instances : pugi::xml_tree_walker {
  bool for_each(pugi::xml_node& node) override {
    const std::string_view tag = node.name();
    const std::string id = node.attribute("id").value();
    if (tag == "geometry") geometries.emplace(id, node);
    if (tag == "node") nodes.emplace(id, node);
    if (tag == "instance_geometry" || tag == "instance_node") all.push_back(node);
    return true;
  }
  Elements geometries, nodes;
  std::vector<pugi::xml_node> all;
};

// What geometries are made of. Inputs lose their children, which mean nothing.
struct Values : pugi::xml_tree_walker {
  bool for_each(pugi::xml_node& node) override {
    const std::string_view tag = node.name();
    const std::string id = node.attribute("id").value();
    if (tag == "source" || tag == "vertices") sources.emplace(id, node);
    if (tag.ends_with("_array")) arrays.emplace(id, node);
    if (tag == "accessor") accessors.push_back(node);
    if (tag == "input") {
      node.remove_children();
      inputs.push_back(node);
    }
    return true;
  }
  Elements sources, arrays;
  std::vector<pugi::xml_node> accessors, inputs;
};

// Removes elements in the order of the file. In reverse, so that nested ones go before those that contain them.
void remove_all(const std::vector<pugi::xml_node>& elements) {
  for (auto each = elements.rbegin(); each != elements.rend(); ++each) each->parent().remove_child(*each);
}

// What a reference names, after its "#" was added where it lacked; null: nothing.
pugi::xml_node named(pugi::xml_attribute reference, const Elements& elements) {
  const std::string_view written = reference.value();
  const bool is_marked = written.starts_with('#');
  const auto found = elements.find(written.substr(is_marked ? 1 : 0));
  if (found == elements.end()) return {};
  if (!is_marked) reference.set_value(("#" + found->first).c_str());
  return found->second;
}

class ColladaReferences {
 public:
  ColladaReferences(XmlText& text, PartSource& file) : text_(text), file_(file) {}

  void run() {
    pugi::xml_node collada = text_.document().child("COLLADA");
    leave_out_instances(collada);
    collada.traverse(values_);
    std::vector<pugi::xml_node> broken;
    for (const pugi::xml_node& input : values_.inputs) {
      if (is_in_geometry(input) && !is_whole(input)) broken.push_back(input);
    }
    for (const pugi::xml_node& input : broken) leave_out(input);
    broken.clear();
    for (const pugi::xml_node& accessor : values_.accessors) {
      const bool is_read = positions_.contains(accessor);  // what is wrong with it is an error
      if (!named(accessor.attribute("source"), values_.arrays) && !is_read) broken.push_back(accessor);
    }
    remove_all(broken);
    instances_.give(file_, "reference", "names no node or geometry of the file; the instance is left out");
    inputs_.give(file_, "reference", "names no values of the file, or fewer than there are; they are left out");
  }

 private:
  static bool is_in_geometry(pugi::xml_node node) {
    while (node && node.name() != std::string_view("mesh")) node = node.parent();
    return static_cast<bool>(node);
  }

  void leave_out_instances(pugi::xml_node collada) {
    Instances instances;
    collada.traverse(instances);
    std::vector<pugi::xml_node> broken;
    for (const pugi::xml_node& each : instances.all) {
      const bool is_node = each.name() == std::string_view("instance_node");
      if (named(each.attribute("url"), is_node ? instances.nodes : instances.geometries)) continue;
      instances_.add(text_.at(each), each.attribute("url").value());
      broken.push_back(each);
    }
    remove_all(broken);
  }

  // Whether an input names values, and as many as its primitives ask for.
  bool is_whole(const pugi::xml_node& input) {
    const bool is_needed = semantic_of(input) == "VERTEX" || semantic_of(input) == "POSITION";
    const pugi::xml_node source = named(input.attribute("source"), values_.sources);
    if (!source && is_needed) {
      fail_at(text_.at(input), "attribute \"source\": " + in_quotes(input.attribute("source").value()) +
                                   " is not in the file, which has no positions without it");
    }
    const pugi::xml_node accessor = accessor_of(source);
    if (semantic_of(input) == "VERTEX") {
      check_vertices(input, source);
    } else if (semantic_of(input) == "POSITION") {
      positions_.insert(accessor);
      named(accessor.attribute("source"), values_.arrays);
    }
    if (is_needed) return true;
    if (!accessor || !named(accessor.attribute("source"), values_.arrays)) return false;
    return is_vertices(input.parent()) || largest_index(input) < accessor.attribute("count").as_llong();
  }

  static std::string_view semantic_of(const pugi::xml_node& input) { return input.attribute("semantic").value(); }
  static bool is_vertices(const pugi::xml_node& node) { return node.name() == std::string_view("vertices"); }
  static pugi::xml_node accessor_of(const pugi::xml_node& source) {
    return source.child("technique_common").child("accessor");
  }

  void check_vertices(const pugi::xml_node& input, const pugi::xml_node& vertices) const {
    if (!is_vertices(vertices)) {
      fail_at(text_.at(input), "attribute \"source\": " + in_quotes(input.attribute("source").value()) +
                                   " is a source, expected the id of vertices");
    }
    const pugi::xml_node position = vertices.find_child_by_attribute("input", "semantic", "POSITION");
    if (!position) fail_at(text_.at(vertices), "vertices have no input of the semantic POSITION");
    const long long largest = largest_index(input);
    const std::string_view source = position.attribute("source").value();
    const auto found = values_.sources.find(source.substr(source.starts_with('#') ? 1 : 0));
    if (found == values_.sources.end()) return;  // which the input of the positions tells
    const long long count = accessor_of(found->second).attribute("count").as_llong();
    if (largest < count) return;
    fail_at(text_.at(input.parent()), std::string(input.parent().name()) + " names the vertex " +
                                          std::to_string(largest) + ", but there are " + std::to_string(count));
  }

  static std::size_t stride_of(const pugi::xml_node& primitives) {
    std::size_t stride = 1;
    for (const pugi::xml_node& input : primitives.children("input")) {
      stride = std::max<std::size_t>(stride, input.attribute("offset").as_uint() + std::size_t{1});
    }
    return stride;
  }

  // Calls visit(list) for each <p> of primitives, those of polygons with holes included.
  template <class Visit>
  static void for_each_list(const pugi::xml_node& primitives, const Visit& visit) {
    for (const pugi::xml_node& child : primitives.children()) {
      if (child.name() == std::string_view("p")) visit(child);
      if (child.name() == std::string_view("ph")) visit(child.child("p"));
    }
  }

  static long long largest_index(const pugi::xml_node& input) {
    const std::size_t offset = input.attribute("offset").as_uint(), stride = stride_of(input.parent());
    long long largest = -1;
    for_each_list(input.parent(), [&](const pugi::xml_node& list) {
      const std::vector<std::string_view> words = words_of(list.child_value());
      for (std::size_t i = offset; i < words.size(); i += stride) {
        long long index = 0;
        std::from_chars(words[i].data(), words[i].data() + words[i].size(), index);
        largest = std::max(largest, index);
      }
    });
    return largest;
  }

  void leave_out(pugi::xml_node input) {
    inputs_.add(text_.at(input), input.attribute("source").value());
    pugi::xml_node primitives = input.parent();
    const std::size_t offset = input.attribute("offset").as_uint(), stride = stride_of(primitives);
    primitives.remove_child(input);
    if (is_vertices(primitives)) return;
    const auto others = primitives.children("input");
    const auto has_offset = [&](const pugi::xml_node& each) { return each.attribute("offset").as_uint() == offset; };
    if (std::any_of(others.begin(), others.end(), has_offset)) return;
    for (pugi::xml_node other : others) {
      pugi::xml_attribute at = other.attribute("offset");
      if (at.as_uint() > offset) at.set_value(at.as_uint() - 1);
    }
    for_each_list(primitives, [&](pugi::xml_node list) {
      std::string kept;
      const std::vector<std::string_view> words = words_of(list.child_value());
      for (std::size_t i = 0; i < words.size(); ++i) {
        if (i % stride != offset) kept.append(words[i]).append(" ");
      }
      list.text().set(kept.c_str());
    });
  }

  XmlText& text_;
  PartSource& file_;
  Values values_;
  std::set<pugi::xml_node> positions_;  // accessors
  RepeatedWarning instances_, inputs_;
};

}  // namespace

void repair_collada_references(XmlText& text, PartSource& file) { ColladaReferences(text, file).run(); }

}  // namespace simvis
