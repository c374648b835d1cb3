// SDF files that tests write, and scenes with one of them.
#pragma once

#include <doctest/doctest.h>

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "scenegraph/flattener.h"
#include "simvis/scene_builder.h"
#include "tests/support/temporary_folder.h"

namespace simvis::test {

using SdfTestFiles = std::map<std::string, std::string>;  // by name relative to the folder

inline std::string sdf_world(const std::string& content, const std::string& version = "1.9") {
  return "<?xml version=\"1.0\"?>\n<sdf version=\"" + version + "\">\n<world name=\"w\">\n" + content +
         "</world></sdf>\n";
}
inline std::string sdf_model(const std::string& content, const std::string& version = "1.9") {
  return "<?xml version=\"1.0\"?>\n<sdf version=\"" + version + "\">\n" + content + "</sdf>\n";
}
inline std::string sdf_visual(const std::string& shape, const std::string& rest = "") {
  return "<visual name='v'><geometry>" + shape + "</geometry>" + rest + "</visual>";
}
inline std::string sdf_box(const std::string& size, const std::string& rest = "") {
  return sdf_visual("<box><size>" + size + "</size></box>", rest);
}

// The file w.sdf in a folder of its own, inserted as the part W.
class SdfScene {
 public:
  explicit SdfScene(const std::string& text, const SdfTestFiles& more_files = {}, const std::string& more = "",
                    const std::string& attributes = "") {
    for (const auto& [name, content] : more_files) {
      std::filesystem::create_directories((folder_ / name).parent_path());
      write_text(folder_ / name, content);
    }
    write_text(folder_ / "w.sdf", text);
    built_ = build_scene(parse_commands("<part file='w.sdf' name='W' insert_at='ROOT' " + attributes + "/>" + more,
                                        "s.xml", folder_.path()));
    built_.scene.read_pictures();  // as a camera does
  }

  BuiltScene& built() { return built_; }
  std::filesystem::path file() const { return folder_ / "w.sdf"; }
  // The warnings without "FILE:".
  std::vector<std::string> warnings() const {
    std::vector<std::string> warnings;
    for (const std::string& warning : built_.scene.warnings()) {
      const std::string file = this->file().string() + ":";
      warnings.push_back(warning.starts_with(file) ? warning.substr(file.size()) : warning);
    }
    return warnings;
  }
  const DrawList& list() {
    if (flattener_ == nullptr) flattener_ = std::make_unique<Flattener>(built_.scene.root());
    return flattener_->update();
  }
  glm::dmat4 place(std::size_t item) {
    const DrawList& drawn = list();
    return drawn.world_from_node[drawn.items.at(item).transform];
  }
  const Material& material(std::size_t item) { return *list().materials[list().items.at(item).material]; }
  const Mesh& mesh(std::size_t item) { return *list().meshes[list().items.at(item).mesh]; }
  glm::dmat4 point(const std::string& name) {
    REQUIRE(built_.scene.has_insertion_point(name));
    return built_.scene.world_from_point(name).value();
  }
  void set(const std::string& element, double value, const std::string& parameter = "value") {
    built_.parameters.set(built_.parameters.index(element, parameter), value);
    for (const std::size_t i : built_.parameters.drain_changed_elements()) {
      const ElementDescriptor& changed = built_.parameters.elements()[i];
      built_.elements[i]->update(built_.parameters.values().subspan(changed.first_value, changed.parameters.size()));
    }
  }
  // The value of a parameter.
  double value(const std::string& element, const std::string& parameter) {
    return built_.parameters.values()[built_.parameters.index(element, parameter)];
  }
  // An attribute of a sensor as written; empty: there is none.
  std::string sensor(const std::string& name, const std::string& attribute) {
    for (const BuiltSensor& each : built_.sensors) {
      if (each.name != name) continue;
      const CommandAttribute* const found = each.command.find(attribute);
      return found == nullptr ? "" : found->value;
    }
    FAIL("there is no sensor " << name);
    return "";
  }

 private:
  TemporaryFolder folder_;
  BuiltScene built_;
  std::unique_ptr<Flattener> flattener_;
};

}  // namespace simvis::test
