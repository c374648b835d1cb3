// A part format for tests: each line of a ".stub" file is a command that the part carries; "broken" is an error, "warn"
// a warning, "point NAME" an insertion point one metre ahead, and "triangle SIZE" a triangle of that size in grey.
#pragma once

#include <glm/gtc/matrix_transform.hpp>
#include <sstream>

#include <simvis/part_importer.h>
#include "tests/support/temporary_folder.h"

namespace simvis {

inline int stub_imports = 0;            ///< how often a file was read
inline ImportRequest last_stub_import;  ///< what the importer was told

inline void add_triangle(Group& root, float size, ContentPool& pool) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {size, 0, 0}, {0, size, 0}};
  mesh.attributes.resize(3);
  mesh.indices = {0, 1, 2};
  compute_bounds(mesh);
  Material grey;
  grey.name = "GREY";
  grey.base_color = {0.5f, 0.5f, 0.5f, 1};
  root.add(std::make_shared<MaterialNode>(pool.intern(std::move(grey))));
  root.add(std::make_shared<Shape>(pool.intern(std::move(mesh))));
}

inline PartContent import_stub(const ImportRequest& request, ContentPool& pool) {
  ++stub_imports;
  last_stub_import = request;
  PartContent content;
  const auto root = std::make_shared<Separator>();
  content.root = root;
  root->name = request.file.filename();
  std::istringstream lines(read_text(request.file));
  for (std::string line; std::getline(lines, line);) {
    if (line == "broken") throw InputError(request.file.string() + ": error: it is broken");
    if (line.starts_with("point ")) {
      const auto place = std::make_shared<Separator>();
      const auto point = std::make_shared<InsertionPoint>();
      point->name = line.substr(6);
      place->add(std::make_shared<Transform>(glm::translate(glm::dmat4(1), {1, 0, 0})));
      place->add(point);
      root->add(place);
    } else if (line.starts_with("triangle ")) {
      add_triangle(*root, std::stof(line.substr(9)), pool);
    } else if (line == "warn") {
      content.warnings.push_back(request.file.string() + ": a warning");
    } else if (!line.empty()) {
      content.commands.push_back(line);
    }
  }
  return content;
}

inline const PartImporterRegistration kStubRegistration({".stub"}, import_stub);

}  // namespace simvis
