#include "import/inventor/inventor_importer.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <string>
#include <utility>

#include <simvis/error.h>
#include <simvis/node.h>
#include "engine/base/input_file.h"
#include "engine/base/read_fence.h"
#include "import/mesh/imported_graph.h"
#include "import/sandbox/import_program.h"
#include "import/sandbox/sandboxed_import.h"

namespace simvis {
namespace {

PartContent import_part(const ImportRequest& request, ContentPool& pool) { return import_inventor(request, pool); }

const PartImporterRegistration inventor_registration({".iv", ".wrl"}, import_part);

}  // namespace

PartContent import_inventor(const ImportRequest& request, ContentPool& pool, std::chrono::milliseconds limit) {
  const PartFence fence(request.file);
  const std::string name = request.file.string();
  // read_whole_file() gives the reason if a file cannot be read; Coin does not.
  if (read_whole_file(request.file).empty()) throw InputError(name + ": error: is empty; expected Inventor or VRML");
  ImportedScene scene = import_in_sandbox({.program = import_program("simvis-import-inventor"),
                                           .library = "Coin",
                                           .file = request.file,
                                           .least = {.time = limit}});
  PartContent content;
  for (const std::string& warning : scene.warnings) {
    content.warnings.push_back(warning.starts_with(name + ":") ? warning : name + ": " + warning);
  }
  content.commands = std::move(scene.commands);
  const auto root = std::make_shared<Separator>();
  root->name = request.file.stem().string();
  if (request.up_given && request.up == UpAxis::y) root->add(std::make_shared<Transform>(kZUpFromYUp));
  std::ranges::move(add_imported_scene(std::move(scene), request.file, Material{}, pool, *root),
                    std::back_inserter(content.warnings));
  content.root = root;
  return content;
}

}  // namespace simvis
