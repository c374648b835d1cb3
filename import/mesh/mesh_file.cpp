#include "import/mesh/mesh_file.h"

#include <strings.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

#include <simvis/node.h>
#include <simvis/part_importer.h>
#include "engine/base/input_file.h"
#include "engine/base/read_error.h"
#include "engine/base/read_fence.h"
#include "import/mesh/imported_graph.h"
#include "import/sandbox/import_program.h"
#include "import/sandbox/sandboxed_import.h"
#include "scenegraph/postponed_shapes.h"

namespace simvis {
namespace {

PartContent import_mesh_file(const ImportRequest& request, ContentPool& pool) {
  if (request.postpone_shapes) {
    ImportRequest now = request;
    now.postpone_shapes = false;
    return postponed_shapes([now](ContentPool& later) { return import_mesh_file(now, later); });
  }
  MeshFileAxes axes = MeshFileAxes::of_format;
  if (request.up_given) axes = request.up == UpAxis::y ? MeshFileAxes::y_up : MeshFileAxes::as_written;
  Material plain;
  plain.double_sided = true;
  return read_mesh_file(request.file, axes, std::make_shared<Material>(plain), pool);
}

// A library would call a pointer of Git LFS a broken file. One that cannot be opened is left to it.
void refuse_pointer(const std::filesystem::path& file) {
  if (is_input_file(file)) InputFile{file};
}

const PartImporterRegistration mesh_registration({".dae", ".las", ".obj", ".pcd", ".ply", ".spz", ".stl", ".zae"},
                                                 import_mesh_file);

}  // namespace

bool is_mesh_file(const std::filesystem::path& file) { return find_part_importer(file) == import_mesh_file; }

PartContent read_mesh_file(const std::filesystem::path& file, MeshFileAxes axes,
                           std::shared_ptr<const Material> fallback, ContentPool& pool) {
  const PartFence fence(file);
  const auto ends_with = [&](const char* ending) { return ::strcasecmp(file.extension().c_str(), ending) == 0; };
  const bool is_y_up = ends_with(".dae") || ends_with(".zae") || ends_with(".spz");
  const bool y_up = axes == MeshFileAxes::y_up || (axes == MeshFileAxes::of_format && is_y_up);
  refuse_pointer(file);
  ImportedScene scene = import_in_sandbox({.program = import_program("simvis-import-mesh"),
                                           .library = ends_with(".dae") || ends_with(".zae") ? "Assimp" : "SimVis",
                                           .file = file,
                                           .ignore_up_axis = axes != MeshFileAxes::of_format});
  const glm::dmat4 part_from_file = y_up ? kZUpFromYUp : glm::dmat4(1);
  for (ImportedNode& node : scene.nodes) {
    if (node.parent == kNoParent) node.parent_from_node = part_from_file * node.parent_from_node;
  }
  PartContent content;
  content.warnings = std::move(scene.warnings);
  const auto root = std::make_shared<Separator>();
  root->name = file.stem().string();
  std::ranges::move(add_imported_scene(std::move(scene), file, *fallback, pool, *root),
                    std::back_inserter(content.warnings));
  content.root = root;
  return content;
}

}  // namespace simvis
