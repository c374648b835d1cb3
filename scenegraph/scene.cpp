#include "scenegraph/scene.h"

#include <algorithm>

#include "scenegraph/attributes.h"
#include "scenegraph/part_importer.h"
#include "scenegraph/pose_attribute.h"

namespace simvis {
namespace {

constexpr std::string_view kPartCommonAttributes[] = {"file", "name", "insert_at", kPoseOffset};
constexpr AttributeSpec kPartAttributes[] = {{
    .name = "up",
    .kind = AttributeKind::choice,
    .text = "which axis of the file points up; the format's own if not given",
    .choices = "y z",
}};

std::filesystem::path find_part_file(const Command& command) {
  const CommandAttribute& file = command.require("file");
  const std::filesystem::path path = command.folder / file.value;
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    fail_at(file.where, "there is no part file " + in_quotes(path.string()));
  }
  if (!std::filesystem::is_regular_file(path, error)) {
    fail_at(file.where, in_quotes(path.string()) + " is not a file, expected a part file");
  }
  return path;
}

PartImporter find_importer(const std::filesystem::path& path, const Location& where) {
  if (const PartImporter importer = find_part_importer(path)) return importer;
  std::string known;
  for (const std::string& ending : known_part_endings()) known += (known.empty() ? "" : ", ") + ending;
  fail_at(where, "part file " + in_quotes(path.string()) + " is of an unknown kind, expected one of: " + known);
}

// "world.glb: error: no buffers" -> "world.glb: no buffers", to stand behind another "error:".
std::string without_error_word(std::string message) {
  constexpr std::string_view kWord = ": error: ";
  const std::size_t at = message.find(kWord);
  return at == std::string::npos ? message : message.replace(at, kWord.size(), ": ");
}

}  // namespace

void rethrow_from_part(const Command& part, const InputError& error) {
  fail_at(part.where, "part " + part.require("name").value + ": " + without_error_word(error.what()));
}

Scene::Scene() : root_(std::make_shared<Group>()) {
  root_->name = "ROOT";
  const auto point = std::make_shared<InsertionPoint>();
  point->name = root_->name;
  root_->add(point);
  places_[root_->name] = {root_.get(), point.get()};
  part_names_.reserve(root_->name);
}

const PartContent& Scene::insert_part(const Command& command) {
  const CommandAttribute& name = command.require("name");
  const std::optional<glm::dmat4> offset = pose_offset(command);
  const Place at = place(command);
  const PartContent& content = load(command);
  part_names_.claim(name);

  const auto separator = std::make_shared<Separator>();
  separator->name = name.value;
  const auto point = std::make_shared<InsertionPoint>();
  point->name = name.value;
  if (offset) separator->add(std::make_shared<Transform>(*offset));
  separator->add(point);
  separator->add(content.root);
  places_[name.value] = {separator.get(), point.get()};
  at.parent->insert_before(*at.point, separator);
  return content;
}

void Scene::insert(const Command& command, NodePtr node) {
  const Place& at = place(command);
  at.parent->insert_before(*at.point, std::move(node));
}

bool Scene::has_insertion_point(std::string_view name) const { return places_.find(name) != places_.end(); }

std::vector<std::string_view> Scene::insertion_points() const {
  std::vector<std::string_view> names;
  for (const auto& [name, place] : places_) names.push_back(name);
  return names;
}

const Scene::Place& Scene::place(const Command& command) const {
  const CommandAttribute& name = command.require("insert_at");
  const auto found = places_.find(name.value);
  if (found == places_.end()) {
    fail_at(name.where, "there is no insertion point " + in_quotes(name.value) +
                            suggestion(name.value, insertion_points()) +
                            " (expected ROOT or the name of a part inserted before)");
  }
  return found->second;
}

const PartContent& Scene::load(const Command& command) {
  const AttributeValues attributes(command, kPartAttributes, kPartCommonAttributes);
  const std::filesystem::path path = find_part_file(command);
  const PartImporter importer = find_importer(path, command.require("file").where);
  ImportRequest request{.file = path};
  std::error_code error;
  std::filesystem::path canonical = std::filesystem::canonical(path, error);
  if (error) canonical = path;
  std::string key = canonical.string();
  if (attributes.is_set("up")) {
    request.up_given = true;
    request.up = attributes.choice("up") == "y" ? UpAxis::y : UpAxis::z;
    key += "|" + attributes.choice("up");
  }
  if (const auto known = parts_.find(key); known != parts_.end()) return known->second;
  try {
    PartContent content = importer(request, pool_);
    content.file = canonical;
    for (const std::string& warning : content.warnings) {
      if (std::ranges::find(warnings_, warning) == warnings_.end()) warnings_.push_back(warning);
    }
    return parts_.emplace(std::move(key), std::move(content)).first->second;
  } catch (const InputError& wrong) {
    rethrow_from_part(command, wrong);
  }
}

}  // namespace simvis
