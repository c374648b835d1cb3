#include "import/programs/collada/collada_uv_sets.h"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "import/programs/repeated_warning.h"

namespace simvis {
namespace {

using Numbers = std::map<unsigned, unsigned>;  // number of a set in the file -> number as Assimp stores it

std::vector<pugi::xml_node> find_elements(pugi::xml_node root, std::string_view name) {
  struct Walker : pugi::xml_tree_walker {
    bool for_each(pugi::xml_node& node) override {
      if (node.name() == name) found.push_back(node);
      return true;
    }
    std::string_view name;
    std::vector<pugi::xml_node> found;
  } walker;
  walker.name = name;
  root.traverse(walker);
  return walker.found;
}

class UvSets {
 public:
  UvSets(XmlText& text, AssimpFile& file) : text_(text), file_(file), collada_(text.document().child("COLLADA")) {}

  void run() {
    for (const pugi::xml_node& library : collada_.children("library_geometries")) {
      for (const pugi::xml_node& geometry : library.children("geometry")) number_sets(geometry);
    }
    for (const pugi::xml_node& instance : find_elements(collada_, "instance_geometry")) read_bindings(instance);
    for (const pugi::xml_node& library : collada_.children("library_effects")) {
      for (const pugi::xml_node& texture : find_elements(library, "texture")) set_name(texture);
    }
    unbound_.give(file_, "texture coordinates",
                  "no <bind_vertex_input> binds them; the set of the name's number, or "
                  "else the first, is taken");
    ambiguous_.give(file_, "texture coordinates", "they are bound to several sets; the first of these is taken");
  }

 private:
  void number_sets(const pugi::xml_node& geometry) {
    const std::string url = std::string("#") + geometry.attribute("id").value();
    for (const pugi::xml_node& primitives : geometry.child("mesh").children()) {
      std::vector<pugi::xml_node> inputs;
      for (const pugi::xml_node& input : primitives.children("input")) {
        if (input.attribute("semantic").value() == std::string_view("TEXCOORD")) inputs.push_back(input);
      }
      std::ranges::stable_sort(inputs, {},
                               [](const pugi::xml_node& input) { return input.attribute("set").as_uint(); });
      Numbers& numbers = numbers_[{url, primitives.attribute("material").value()}];
      for (unsigned i = 0; i < inputs.size(); ++i) {
        pugi::xml_attribute set = inputs[i].attribute("set");
        numbers.try_emplace(set.as_uint(), i);
        if (set.as_uint() == i) continue;
        if (!set) set = inputs[i].append_attribute("set");
        set.set_value(i);
      }
      largest_ = std::max(largest_, inputs.size());
    }
  }

  void read_bindings(const pugi::xml_node& instance) {
    const std::string url = instance.attribute("url").value();
    for (const pugi::xml_node& material : find_elements(instance, "instance_material")) {
      const auto numbers = numbers_.find({url, material.attribute("symbol").value()});
      if (numbers == numbers_.end()) continue;
      for (const pugi::xml_node& binding : material.children("bind_vertex_input")) {
        const auto number = numbers->second.find(binding.attribute("input_set").as_uint());
        if (number == numbers->second.end()) continue;
        const std::string name = binding.attribute("semantic").value();
        const auto [known, is_new] = bound_.try_emplace(name, number->second);
        if (!is_new && known->second != number->second) ambiguous_.add(text_.at(binding), name);
      }
    }
  }

  void set_name(pugi::xml_node texture) {
    pugi::xml_attribute name = texture.attribute("texcoord");
    const auto bound = bound_.find(name.value());
    unsigned number = 0;
    if (bound != bound_.end()) {
      number = bound->second;
    } else {
      number = number_in(name.value());
      if (largest_ > 1) unbound_.add(text_.at(texture), name.value());
    }
    if (!name) name = texture.append_attribute("texcoord");
    name.set_value(("UVSET" + std::to_string(number)).c_str());
  }

  // The number at the end of a name such as "CHANNEL1", if there is such a set.
  unsigned number_in(std::string_view name) const {
    const std::size_t digits = name.find_last_not_of("0123456789") + 1;
    unsigned number = 0;
    std::from_chars(name.data() + digits, name.data() + name.size(), number);
    return number < largest_ ? number : 0;
  }

  XmlText& text_;
  AssimpFile& file_;
  pugi::xml_node collada_;
  std::map<std::pair<std::string, std::string>, Numbers> numbers_;  // by "#id" of the geometry and material's symbol
  std::map<std::string, unsigned, std::less<>> bound_;              // set, by name
  std::size_t largest_ = 0;                                         // number of sets of the primitive that has most
  RepeatedWarning unbound_, ambiguous_;
};

}  // namespace

void set_collada_uv_sets(XmlText& text, AssimpFile& file) { UvSets(text, file).run(); }

}  // namespace simvis
