// The classes that labels give to what a part file brings.
#pragma once

#include <map>
#include <string>

#include "tests/support/element_scene.h"

namespace simvis::test {

using ClassCounts = std::map<std::string, int>;

/// A scene with one file, which is the part M, and these commands.
inline Simulation scene_of_file(const TemporaryFolder& folder, const std::string& file, const std::string& content,
                                const std::string& commands) {
  write_text(folder / file, content);
  return Simulation::from_string(
      "<simvis><part name='M' insert_at='ROOT' file='" + file + "'/>" + commands + "</simvis>", {}, folder.path());
}

/// How many shapes have each class there.
inline ClassCounts classes_in(const std::string& file, const std::string& content, const std::string& commands) {
  const TemporaryFolder folder;
  const Simulation simulation = scene_of_file(folder, file, content, commands);
  ClassCounts counts;
  for (const SceneItem& item : simulation.items()) ++counts[item.label];
  return counts;
}

inline std::string file_label(const std::string& name, const std::string& attributes, int id) {
  return "<element type='label' name='" + name + "' insert_at='ROOT' " + attributes + " class='" + name +
         "' class_id='" + std::to_string(id) + "'/>";
}

}  // namespace simvis::test
