// MJCF models that tests write, and scenes with one of them.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "scenegraph/flattener.h"
#include "simvis/scene_builder.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace simvis::test {

// Products of a few rotations in double, and numbers of files with 16 digits.
inline constexpr double kMjcfPlace = 1e-12;

// The file m.xml in a folder of its own, inserted as the part M.
class MjcfScene {
 public:
  explicit MjcfScene(const std::string& content, const std::map<std::string, std::string>& files = {}) {
    for (const auto& [name, text] : files) {
      std::filesystem::create_directories((folder_ / name).parent_path());
      write_text(folder_ / name, text);
    }
    write_text(folder_ / "m.xml", "<mujoco model='m'>" + content + "</mujoco>");
    built_ = build_scene(parse_commands("<part file='m.xml' name='M' insert_at='ROOT'/>", "s.xml", folder_.path()));
    built_.scene.read_pictures();  // as a camera does
    flattener_ = std::make_unique<Flattener>(built_.scene.root());
  }
  const BuiltScene& built() const { return built_; }
  const DrawList& list() { return flattener_->update(); }
  glm::dmat4 place(std::size_t item) {
    const DrawList& drawn = list();
    return drawn.world_from_node[drawn.items.at(item).transform];
  }
  const Mesh& mesh(std::size_t item) { return *list().meshes[list().items.at(item).mesh]; }
  const Material& material(std::size_t item) { return *list().materials[list().items.at(item).material]; }
  glm::dmat4 point(const std::string& name) {
    REQUIRE(built_.scene.has_insertion_point(name));
    return built_.scene.world_from_point(name).value();
  }
  double value(const std::string& element, const std::string& parameter) {
    return built_.parameters.values()[built_.parameters.index(element, parameter)];
  }
  std::pair<double, double> limits(const std::string& element) {
    const auto found = std::ranges::find(built_.parameters.elements(), element, &ElementDescriptor::name);
    REQUIRE(found != built_.parameters.elements().end());
    return {found->parameters[0].min, found->parameters[0].max};
  }
  void set(const std::string& joint, double value, const std::string& parameter = "value") {
    built_.parameters.set(built_.parameters.index(joint, parameter), value);
    for (const std::size_t i : built_.parameters.drain_changed_elements()) {
      const ElementDescriptor& changed = built_.parameters.elements()[i];
      built_.elements[i]->update(built_.parameters.values().subspan(changed.first_value, changed.parameters.size()));
    }
  }
  std::vector<std::string> warnings() const {
    std::vector<std::string> warnings;
    for (const std::string& warning : built_.scene.warnings()) {
      const std::string file = (folder_ / "m.xml").string() + ":";
      warnings.push_back(warning.starts_with(file) ? warning.substr(file.size()) : warning);
    }
    return warnings;
  }

 private:
  TemporaryFolder folder_;
  BuiltScene built_;
  std::unique_ptr<Flattener> flattener_;
};

inline std::string mjcf_world(const std::string& content) { return "<worldbody>" + content + "</worldbody>"; }

inline void check_place(const glm::dmat4& seen, const glm::dvec3& x, const glm::dvec3& y, const glm::dvec3& at) {
  CHECK(glm::length(glm::dvec3(seen[0]) - x) < kMjcfPlace);
  CHECK(glm::length(glm::dvec3(seen[1]) - y) < kMjcfPlace);
  CHECK(glm::length(glm::dvec3(seen[3]) - at) < kMjcfPlace);
}

inline std::string mjcf_error(const std::string& content, const std::map<std::string, std::string>& files = {}) {
  return error_of([&] { MjcfScene scene(content, files); });
}

}  // namespace simvis::test
