#include "import/mjcf/mjcf_attachments.h"

#include <system_error>
#include <vector>

#include "engine/base/read_error.h"

namespace simvis {
namespace {

// The body of a name, anywhere below an element. The frames around it do not count, as in MuJoCo.
std::optional<MjcfElement> find_body(const MjcfElement& within, const std::string& name, int depth) {
  if (depth > kMaxMjcfDepth) within.fail("is nested too deeply");
  for (const MjcfElement& child : within.children()) {
    const bool is_body = child.tag() == "body";
    if (is_body && child.written("name") == name) return child;
    if (!is_body && child.tag() != "frame" && child.tag() != "replicate") continue;
    if (auto found = find_body(child, name, depth + 1)) return found;
  }
  return std::nullopt;
}

}  // namespace

const MjcfModel& MjcfAttachments::model_of(const MjcfElement& asset) {
  const std::string name = asset.text("file");
  const std::filesystem::path file = asset.model().file().parent_path() / name;
  if (!is_input_file(file)) asset.fail("names a file that is not there: " + in_quotes(name));
  std::error_code error;
  const MjcfModel*& model = read_[std::filesystem::canonical(file, error)];
  if (model == nullptr) model = &tree_.models.emplace_back(file);
  return *model;
}

MjcfAttached MjcfAttachments::find(const MjcfElement& attach) {
  const std::string name = attach.text("model");
  MjcfAttached found;
  for (const MjcfElement& section : attach.model().sections("asset")) {
    for (const MjcfElement& asset : section.children()) {
      if (asset.tag() != "model" || found.model != nullptr) continue;
      const auto own = asset.written("name");
      if (own && *own != name) continue;
      const MjcfModel& model = model_of(asset);
      if (own || model.name() == name) found.model = &model;
    }
  }
  if (found.model == nullptr) {
    attach.fail("names the model " + in_quotes(name) + ", which is not there, expected that of an <asset><model>");
  }
  const std::string body = attach.text("body");
  if (body.empty()) return found;
  for (const MjcfElement& world : found.model->sections("worldbody")) {
    if (!found.body) found.body = find_body(world, body, 0);
  }
  if (!found.body) {
    attach.fail("names the body " + in_quotes(body) + ", which " + found.model->file().filename().string() +
                " does not have");
  }
  return found;
}

}  // namespace simvis
