// URDF robots that tests write, and scenes with one of them.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "scenegraph/flattener.h"
#include "simvis/scene_builder.h"
#include "tests/support/temporary_folder.h"

namespace simvis::test {

inline std::string link_xml(const std::string& name, const std::string& content = "") {
  return "<link name=\"" + name + "\">" + content + "</link>\n";
}
inline std::string joint_xml(const std::string& name, const std::string& type, const std::string& parent,
                             const std::string& child, const std::string& rest = "") {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent + "\"/><child link=\"" + child +
         "\"/>" + rest + "</joint>\n";
}
inline std::string robot(const std::string& content) {
  return "<?xml version=\"1.0\"?>\n<robot name=\"r\">\n" + content + "</robot>\n";
}

// A file in a folder of its own, inserted as the part ROBOT.
class UrdfScene {
 public:
  explicit UrdfScene(const std::string& content, const std::string& more = "") { build(robot(content), more); }
  /// The robot names files that stand beside it.
  UrdfScene(const std::string& content, const std::map<std::string, std::string>& files) {
    for (const auto& [name, bytes] : files) write_text(folder_ / name, bytes);
    build(robot(content), "");
  }

  BuiltScene& built() { return built_; }
  const std::vector<std::string>& warnings() const { return built_.scene.warnings(); }
  std::filesystem::path file() const { return folder_ / "r.urdf"; }
  const DrawList& list() {
    if (flattener_ == nullptr) flattener_ = std::make_unique<Flattener>(built_.scene.root());
    return flattener_->update();
  }
  void set(const std::string& element, double value, const std::string& parameter = "value") {
    built_.parameters.set(built_.parameters.index(element, parameter), value);
    for (const std::size_t i : built_.parameters.drain_changed_elements()) {
      const ElementDescriptor& changed = built_.parameters.elements()[i];
      built_.elements[i]->update(built_.parameters.values().subspan(changed.first_value, changed.parameters.size()));
    }
  }
  glm::dmat4 place(std::size_t item) {
    const DrawList& drawn = list();
    return drawn.world_from_node[drawn.items.at(item).transform];
  }

 private:
  void build(const std::string& text, const std::string& more) {
    write_text(folder_ / "r.urdf", text);
    built_ = build_scene(
        parse_commands("<part file='r.urdf' name='ROBOT' insert_at='ROOT'/>" + more, "s.xml", folder_.path()));
    built_.scene.read_pictures();  // as a camera does
  }
  TemporaryFolder folder_;
  BuiltScene built_;
  std::unique_ptr<Flattener> flattener_;
};

}  // namespace simvis::test
