#include "scenegraph/import/inventor/inventor_importer.h"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <simvis/error.h>
#include "scenegraph/import/inventor/foreign_scene.h"
#include "scenegraph/import/inventor/inventor_reader.h"
#include "scenegraph/import/mesh/input_file.h"

namespace simvis {
namespace {

constexpr std::size_t kMaxMessages = 5;

// The texts of the log's lines of a kind, each once.
std::vector<std::string> messages(const ChildReport& report, char kind) {
  std::vector<std::string> texts;
  for (const std::string& line : report.log) {
    if (line.empty() || line[0] != kind) continue;
    const std::string text = line.substr(1);
    if (std::find(texts.begin(), texts.end(), text) == texts.end()) texts.push_back(text);
  }
  return texts;
}

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what, const ChildReport& report) {
  std::vector<std::string> said = messages(report, kInventorError);
  if (said.empty()) said = messages(report, kInventorWarning);
  std::string text = file.string() + ": error: " + what;
  for (std::size_t i = 0; i < std::min(said.size(), kMaxMessages); ++i) text += "; " + said[i];
  if (said.size() > kMaxMessages) text += "; and " + std::to_string(said.size() - kMaxMessages) + " more messages";
  throw InputError(text);
}

ForeignScene read_in_child(const std::filesystem::path& file, std::chrono::milliseconds limit) {
  const auto work = [&file](ChildLog& log) { return pack_foreign_scene(read_with_coin(file, log)); };
  ChildLimits limits;
  limits.time = limit;
  const ChildReport report = run_in_child(work, limits);
  switch (report.end) {
    case ChildEnd::finished:
      break;
    case ChildEnd::threw:
      fail(file, report.reason, report);
    case ChildEnd::crashed:
      fail(file, "Coin crashed on it (" + report.reason + ")", report);
    case ChildEnd::took_too_long:
      fail(file, "Coin did not finish it within " + std::to_string(limit.count()) + " ms", report);
  }
  // Coin goes on after some errors, with a part of the file.
  if (!messages(report, kInventorError).empty()) fail(file, "Coin cannot read all of it", report);
  ForeignScene scene = unpack_foreign_scene(report.result, file.string() + ": error: ");
  const std::vector<std::string> said = messages(report, kInventorWarning);
  scene.warnings.insert(scene.warnings.begin(), said.begin(), said.end());
  return scene;
}

class GraphOfInventor {
 public:
  GraphOfInventor(ForeignScene&& scene, ContentPool& pool) : scene_(std::move(scene)) {
    std::vector<std::shared_ptr<const Texture>> textures;
    for (Texture& texture : scene_.textures) textures.push_back(pool.intern(std::move(texture)));
    for (ForeignMaterial& source : scene_.materials) {
      if (source.texture != kNoForeignTexture) source.material.base_color_texture = textures[source.texture];
      materials_.push_back(std::make_shared<MaterialNode>(pool.intern(std::move(source.material))));
    }
    for (Mesh& mesh : scene_.meshes) {
      compute_bounds(mesh);
      shapes_.push_back(std::make_shared<Shape>(pool.intern(std::move(mesh))));
    }
  }

  void add_to(Group& root) const {
    for (const ForeignLight& light : scene_.lights) {
      add_placed(root, light.name, light.part_from_light, {std::make_shared<LightNode>(light.light)});
    }
    for (const ForeignShape& shape : scene_.shapes) {
      add_placed(root, shape.name, shape.part_from_shape, {materials_[shape.material], shapes_[shape.mesh]});
    }
  }

 private:
  static void add_placed(Group& root, const std::string& name, const glm::dmat4& place,
                         const std::vector<NodePtr>& nodes) {
    const auto separator = std::make_shared<Separator>();
    separator->name = name;
    if (place != glm::dmat4(1)) separator->add(std::make_shared<Transform>(place));
    for (const NodePtr& node : nodes) separator->add(node);
    root.add(separator);
  }

  ForeignScene scene_;
  std::vector<NodePtr> materials_, shapes_;
};

PartContent import_part(const ImportRequest& request, ContentPool& pool) { return import_inventor(request, pool); }

const PartImporterRegistration registration({".iv", ".wrl"}, import_part);

}  // namespace

PartContent import_inventor(const ImportRequest& request, ContentPool& pool, std::chrono::milliseconds limit) {
  // (x, y, z) -> (x, -z, y)
  const glm::dmat4 z_up_from_y_up(1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1);
  const std::string name = request.file.string();
  // It says what is wrong with a file that cannot be read; Coin does not.
  if (read_whole_file(request.file).empty()) throw InputError(name + ": error: is empty; expected Inventor or VRML");
  ForeignScene scene = read_in_child(std::filesystem::absolute(request.file), limit);
  PartContent content;
  for (const std::string& warning : scene.warnings) content.warnings.push_back(name + ": warning: " + warning);
  content.commands = std::move(scene.commands);
  const auto root = std::make_shared<Separator>();
  root->name = request.file.stem().string();
  if (request.up_given && request.up == UpAxis::y) root->add(std::make_shared<Transform>(z_up_from_y_up));
  GraphOfInventor(std::move(scene), pool).add_to(*root);
  content.root = root;
  return content;
}

}  // namespace simvis
