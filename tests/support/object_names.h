// The names of the objects of a scene.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include <simvis/scene.h>

namespace simvis::test {

/// Sorted; without a kind those of all objects, ROOT included.
inline std::vector<std::string> object_names(const Scene& scene, std::optional<ObjectKind> kind = {}) {
  std::vector<std::string> names;
  for (const Object& object : scene.objects().all()) {
    if (!kind || object.kind == *kind) names.push_back(object.name);
  }
  std::ranges::sort(names);
  return names;
}

inline std::vector<std::string> part_names(const Scene& scene) { return object_names(scene, ObjectKind::part); }

}  // namespace simvis::test
