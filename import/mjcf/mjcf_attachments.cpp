#include "import/mjcf/mjcf_attachments.h"

#include <system_error>
#include <vector>

#include "engine/base/read_error.h"

namespace simvis {
namespace {

// The bodies with a name, anywhere below an element; the first one of a name counts. The frames around a body do not
// count, as in MuJoCo.
void collect_bodies(const MjcfElement& within, int depth, std::map<std::string, MjcfElement>& bodies) {
  if (depth > kMaxMjcfDepth) within.fail("is nested too deeply");
  for (const MjcfElement& child : within.children()) {
    const bool is_body = child.tag() == "body";
    if (is_body) bodies.try_emplace(child.written("name").value_or(""), child);
    if (!is_body && child.tag() != "frame" && child.tag() != "replicate") continue;
    collect_bodies(child, depth + 1, bodies);
  }
}

}  // namespace

const MjcfModel& MjcfAttachments::model_of(const MjcfElement& asset) {
  const std::string name = asset.text("file");
  const std::filesystem::path file = asset.model().file().parent_path() / mjcf_path(name);
  if (!is_input_file(file)) asset.fail("names a file that is not there: " + in_quotes(name));
  std::error_code error;
  const MjcfModel*& model = read_[std::filesystem::canonical(file, error)];
  if (model == nullptr) model = &tree_.models.emplace_back(file);
  return *model;
}

const MjcfAttachments::Named& MjcfAttachments::names_in(const MjcfModel& model) {
  const auto [known, is_new] = names_.try_emplace(&model);
  if (!is_new) return known->second;
  for (const MjcfElement& section : model.sections("asset")) {
    for (const MjcfElement& asset : section.children()) {
      if (asset.tag() != "model") continue;
      if (const auto own = asset.written("name")) {
        known->second.by_name.try_emplace(*own, asset);
      } else {
        known->second.others.push_back(asset);
      }
    }
  }
  return known->second;
}

const MjcfModel* MjcfAttachments::find_model(const MjcfElement& attach, const std::string& name) {
  const MjcfModel*& found = found_[{&attach.model(), name}];
  if (found != nullptr) return found;
  const Named& names = names_in(attach.model());
  if (const auto named = names.by_name.find(name); named != names.by_name.end())
    return found = &model_of(named->second);
  for (const MjcfElement& asset : names.others) {
    const MjcfModel& model = model_of(asset);
    if (model.name() == name) return found = &model;
  }
  return nullptr;
}

const MjcfElement* MjcfAttachments::find_body(const MjcfModel& model, const std::string& name) {
  const auto [known, is_new] = bodies_.try_emplace(&model);
  if (is_new) {
    for (const MjcfElement& world : model.sections("worldbody")) collect_bodies(world, 0, known->second);
  }
  const auto body = known->second.find(name);
  return body == known->second.end() ? nullptr : &body->second;
}

MjcfAttached MjcfAttachments::find(const MjcfElement& attach) {
  const std::string name = attach.text("model");
  MjcfAttached found{.model = find_model(attach, name)};
  if (found.model == nullptr) {
    attach.fail("names the model " + in_quotes(name) + ", which is not there, expected that of an <asset><model>");
  }
  const std::string body = attach.text("body");
  if (body.empty()) return found;
  const MjcfElement* const element = find_body(*found.model, body);
  if (element == nullptr) {
    attach.fail("names the body " + in_quotes(body) + ", which " + found.model->file().filename().string() +
                " does not have");
  }
  found.body = *element;
  return found;
}

}  // namespace simvis
