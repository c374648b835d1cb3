#include "import/programs/collada/collada_pictures.h"

#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "import/programs/repeated_warning.h"

namespace simvis {
namespace {

// COLLADA 1.4 has the file in <init_from>, 1.5 in <init_from><ref>; <data> holds a picture within the file.
bool names_file(const pugi::xml_node& image) {
  const pugi::xml_node from = image.child("init_from");
  return *from.child_value() != '\0' || *from.child_value("ref") != '\0' || image.child("data") || from.child("hex");
}

// Assimp crashes on an image whose <init_from> is empty, even if no texture refers to it.
void name_file(pugi::xml_node& image) {
  pugi::xml_node from = image.child("init_from");
  if (!from) from = image.append_child("init_from");
  from.text().set("none");
}

// Assimp 5.2 reads images of COLLADA 1.4 alone.
void take_reference(pugi::xml_node& image) {
  pugi::xml_node from = image.child("init_from");
  const std::string file = from.child("ref").text().as_string();
  if (file.empty()) return;
  from.remove_children();
  from.text() = file.c_str();
}

class TextureRemoval : public pugi::xml_tree_walker {
 public:
  explicit TextureRemoval(const XmlText& text) : text_(text) {}

  void run(AssimpFile& file) {
    pugi::xml_node document = text_.document();
    document.traverse(*this);
    pugi::xml_attribute version = document.child("COLLADA").attribute("version");
    if (std::string_view(version.value()).starts_with("1.5")) version = "1.4.1";
    if (images_.empty()) return;
    for (pugi::xml_node& texture : textures_) {
      if (!images_.contains(image_of(texture))) continue;
      texture.set_name("color");
      while (texture.remove_attribute(texture.first_attribute())) {
      }
      while (texture.remove_child(texture.first_child())) {
      }
      texture.text().set("1 1 1 1");
    }
    for (pugi::xml_node& image : nameless_) name_file(image);
    warning_.give(file, "image", "names no file; materials with it are white");
  }

  bool for_each(pugi::xml_node& node) override {
    const std::string_view tag = node.name();
    if (tag == "image") take_reference(node);
    if (tag == "texture") textures_.push_back(node);
    if (tag == "image" && !names_file(node)) {
      nameless_.push_back(node);
      images_.insert(node.attribute("id").value());
      warning_.add(text_.at(node), node.attribute("id").value());
    }
    if (tag != "newparam") return true;
    const std::string sid = node.attribute("sid").value();
    pugi::xml_node sampler = node.child("sampler2D");
    if (const pugi::xml_node surface = node.child("surface")) parameters_[sid] = surface.child_value("init_from");
    if (sampler.child("source")) parameters_[sid] = sampler.child_value("source");
    if (const pugi::xml_node image = sampler.child("instance_image")) {
      const std::string_view url = image.attribute("url").value();
      parameters_[sid] = url.starts_with('#') ? url.substr(1) : url;
      sampler.append_child("source").text() = parameters_[sid].c_str();
    }
    return true;
  }

 private:
  // A texture names a sampler, which names a surface, which names an image; or the image directly.
  std::string image_of(const pugi::xml_node& texture) const {
    constexpr int kSteps = 2;
    std::string name = texture.attribute("texture").value();
    for (int step = 0; step < kSteps; ++step) {
      const auto next = parameters_.find(name);
      if (next == parameters_.end()) break;
      name = next->second;
    }
    return name;
  }

  const XmlText& text_;
  std::vector<pugi::xml_node> textures_;
  std::map<std::string, std::string> parameters_;
  std::vector<pugi::xml_node> nameless_;  // images without a file
  std::set<std::string> images_;          // their names
  RepeatedWarning warning_;
};

}  // namespace

void remove_collada_textures_without_file(XmlText& text, AssimpFile& file) { TextureRemoval(text).run(file); }

}  // namespace simvis
