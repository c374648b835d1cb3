#include "import/sdf/sdf_reader.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include <simvis/attributes.h>
#include "engine/base/read_error.h"
#include "engine/base/read_fence.h"
#include "import/mesh/picture_file.h"
#include "import/model/small_xml.h"
#include "import/sdf/sdf_labels.h"

namespace simvis {
namespace {

constexpr std::size_t kMaxSdfModels = 20'000, kMaxSdfNested = 64;
constexpr int kFirstSdfVersion = 2;
constexpr std::string_view kModel = "model://", kFile = "file://";

SdfElement root_of(SdfFile& file) {
  const pugi::xml_node root = file.text->document().document_element();
  return {root, file};
}

bool is_sdf_root(const SdfElement& root) { return root && (root.tag() == "sdf" || root.tag() == "gazebo"); }

// The 6 of "1.6"; a file without a version counts as of the newest.
int minor_version(std::string_view version) {
  constexpr int kNewest = 99;
  double minor = 0;
  return version.starts_with("1.") && parse_number(version.substr(2), minor) ? static_cast<int>(minor) : kNewest;
}

// `why` says so if it is.
bool is_on_network(std::string_view uri, std::string& why) {
  if (!uri.starts_with("http://") && !uri.starts_with("https://")) return false;
  why = in_quotes(uri) + " is on the network, where no files are looked for";
  return true;
}

// The files of which a folder of a model has one at least.
constexpr const char* kModelFiles[] = {"model.config", "manifest.xml", "model.sdf"};

// Where Gazebo has its own media, such as file://media/materials/scripts/gazebo.material.
constexpr const char* kResourcePath = "GAZEBO_RESOURCE_PATH";

// "3: error: WHAT" -> "3: WHAT; REST", for a warning.
std::string as_warning(const InputError& error, const std::string& rest) {
  return without_word_error(error.what()) + "; " + rest;
}

}  // namespace

SdfFiles::SdfFiles(const std::filesystem::path& top, std::vector<PackageFolder> packages)
    : packages_(std::move(packages)), top_(top, packages_) {}

std::optional<std::filesystem::path> SdfFiles::find(const std::string& uri, const SdfElement& where, std::string& why) {
  if (is_on_network(uri, why)) return std::nullopt;
  PackageFiles& packages = where.file().packages;
  if (uri.starts_with(kModel)) {
    const std::size_t end = std::min(uri.find('/', kModel.size()), uri.size());
    const std::string model = uri.substr(kModel.size(), end - kModel.size());
    const std::string rest = uri.substr(std::min(end + 1, uri.size()));
    if (const auto found = packages.find_model_file(model, rest)) return found;
    if (const auto found = top_.find_model_file(model, rest)) return found;
  }
  const auto found = packages.find(uri, where.at());
  if (!found) why = in_quotes(uri) + " is not there; " + packages.tried();
  return found;
}

std::optional<std::filesystem::path> SdfFiles::find_in_folder(const std::filesystem::path& folder) {
  pugi::xml_document config;
  std::filesystem::path best = folder / "model.sdf";
  int best_version = 0;
  if (load_if_there(folder / "model.config", config) || load_if_there(folder / "manifest.xml", config)) {
    for (const pugi::xml_node& sdf : config.document_element().children("sdf")) {
      const int version = minor_version(sdf.attribute("version").value());
      if (version < best_version) continue;
      best = folder / sdf.text().as_string();
      best_version = version;
    }
  }
  if (is_input_file(best)) return best;
  return std::nullopt;
}

std::optional<std::filesystem::path> SdfFiles::find_model(const std::string& uri, const SdfElement& where,
                                                          std::string& why) {
  if (is_on_network(uri, why)) return std::nullopt;
  std::string name = uri;
  const bool is_model = name.starts_with(kModel);
  if (is_model) name.erase(0, kModel.size());
  if (name.starts_with(kFile)) name.erase(0, kFile.size());
  while (name.ends_with('/')) name.pop_back();
  if (name.empty()) {
    why = "it names no file";
    return std::nullopt;
  }
  std::string tried;
  if (!is_model) {
    const std::filesystem::path path = std::filesystem::path(where.at().file).parent_path() / name;
    if (is_input_file(path)) return path;
    if (const auto found = find_in_folder(path)) return found;
    tried = "tried " + path.string();
  }
  const std::size_t slash = name.find('/');
  const std::string model = name.substr(0, slash);
  const std::string rest = slash == std::string::npos ? "" : name.substr(slash + 1);
  for (PackageFiles* packages : {&where.file().packages, &top_}) {
    if (model.empty()) break;  // an absolute path
    if (const auto file = rest.empty() ? std::nullopt : packages->find_model_file(model, rest)) return file;
    for (const char* in_folder : kModelFiles) {
      const auto file = packages->find_model_file(model, (std::filesystem::path(rest) / in_folder).string());
      if (!file) continue;
      if (const auto found = find_in_folder(file->parent_path())) return found;
    }
    tried = packages->tried();
  }
  why = "model " + in_quotes(uri) + " is not there; " + tried;
  return std::nullopt;
}

std::vector<std::filesystem::path> SdfFiles::find_scripts(const std::string& uri, const SdfElement& where) {
  std::string name = uri;
  if (!name.starts_with(kModel)) {
    if (name.starts_with(kFile)) name.erase(0, kFile.size());
    std::vector<std::filesystem::path> places{std::filesystem::path(where.at().file).parent_path() / name};
    for (const std::filesystem::path& folder : folders_of_variable(kResourcePath)) {
      admit_folder(folder);
      places.push_back(folder / name);
    }
    return places;
  }
  name.erase(0, kModel.size());
  const std::size_t slash = std::min(name.find('/'), name.size());
  std::vector<std::filesystem::path> places;
  for (PackageFiles* packages : {&where.file().packages, &top_}) {
    for (const char* in_folder : kModelFiles) {
      const auto file = packages->find_model_file(name.substr(0, slash), in_folder);
      if (file) places.push_back(file->parent_path() / name.substr(std::min(slash + 1, name.size())));
    }
  }
  return places;
}

void report_unread(const SdfElement& element, ImportReport& report) {
  const std::string_view tag = element.tag();
  constexpr std::string_view kReported[] = {"plugin", "actor",     "audio",   "audio_source",     "gui",  "road",
                                            "state",  "projector", "gripper", "particle_emitter", "sky",  "population",
                                            "fog",    "light",     "battery", "audio_sink",       "event"};
  if (std::ranges::find(kReported, tag) == std::end(kReported)) return;
  report.leave_out("element <" + std::string(tag) + ">", element.at());
}

SdfFile& SdfReader::open(const std::filesystem::path& file) {
  std::error_code error;
  std::filesystem::path key = std::filesystem::canonical(file, error);
  if (error) key = file;
  if (const auto known = known_.find(key); known != known_.end()) return *known->second;
  const auto text = std::make_shared<const XmlText>(XmlText::read(file));
  const int version = minor_version(text->document().document_element().attribute("version").value());
  content_.files.push_back(std::make_unique<SdfFile>(SdfFile{text, files_.as_seen_from(file), version}));
  known_[key] = content_.files.back().get();
  return *content_.files.back();
}

void SdfReader::read(const std::filesystem::path& file) {
  SdfFile& top = open(file);
  const SdfElement root = root_of(top);
  if (!is_sdf_root(root)) root.fail("is the root, expected <sdf>");
  if (top.version < kFirstSdfVersion)
    root.fail("has the version 1." + std::to_string(top.version) + ", expected 1.2 or newer");
  std::error_code error;
  open_.push_back(std::filesystem::canonical(file, error));
  const SdfElement world = root.child("world");
  content_.world.element = root;
  content_.first = world ? world : root;
  bool is_first_world = true;
  std::size_t top_models = 0;
  for (const SdfElement& child : root.children()) {
    if (child.tag() == "world") {
      if (is_first_world) read_world(child);
      if (!is_first_world) report_.leave_out("second <world> of the file", child.at());
      is_first_world = false;
    } else {
      top_models += child.tag() == "model" ? 1 : 0;
      read_child(child, content_.world);
    }
  }
  content_.is_single_model = !world && top_models == 1 && content_.world.items.size() == 1;
}

void SdfReader::read_world(const SdfElement& world) {
  content_.scene = world.child("scene");
  for (const SdfElement& child : content_.scene ? content_.scene.children() : std::vector<SdfElement>()) {
    report_unread(child, report_);
  }
  read_scope(world, content_.world);
}

void SdfReader::read_scope(const SdfElement& element, SdfScope& scope) {
  scope.element = element;
  for (const SdfElement& child : element.children()) read_child(child, scope);
}

void SdfReader::read_child(const SdfElement& child, SdfScope& scope) {
  const std::string_view tag = child.tag();
  const bool is_world = scope.outer == nullptr;
  if (tag == "model") return add_model(child, nullptr, scope);
  if (tag == "include") return read_include(child, scope);
  if (tag == "frame") return read_frame(child, scope);
  if (tag == "joint") return read_joint(child, scope);
  if (tag == "link" && !is_world) {
    add(SdfItemKind::link, child, child.name(), scope).pose = read_sdf_pose(child);
    return;
  }
  if (tag == "light" && is_world) return add_light(child, nullptr);
  if (!is_world && is_sdf_label(child)) return;
  report_unread(child, report_);
}

SdfItem& SdfReader::add(SdfItemKind kind, const SdfElement& element, std::string name, SdfScope& scope) {
  const auto is_taken = [&](const std::string& wanted) {
    const auto known = scope.by_name.find(wanted);
    return known != scope.by_name.end() && known->second->kind == kind;
  };
  if (is_taken(name)) {
    int& number = scope.last_number.try_emplace({kind, name}, 1).first->second;
    std::string other;
    do other = name + "_" + std::to_string(++number);
    while (is_taken(other));
    report_.warn(element.at(), std::string(element.tag()) + " " + in_quotes(name) +
                                   " is there already; this one is called " + in_quotes(other));
    name = std::move(other);
  }
  SdfItem& item = *scope.items.emplace_back(std::make_unique<SdfItem>());
  item.kind = kind;
  item.element = element;
  item.name = name;
  // Up to SDF 1.6, a joint may have the name of a link, which poses then mean.
  SdfItem*& known = scope.by_name[name];
  if (known == nullptr || kind == SdfItemKind::link) known = &item;
  return item;
}

void SdfReader::read_frame(const SdfElement& frame, SdfScope& scope) {
  SdfItem& item = add(SdfItemKind::frame, frame, frame.name(), scope);
  item.pose = read_sdf_pose(frame);
  item.child = frame.attribute("attached_to");
}

void SdfReader::read_joint(const SdfElement& joint, SdfScope& scope) {
  const std::string type = joint.attribute("type");
  if (type == "gearbox") return report_.leave_out("joint of type gearbox", joint.at());
  SdfItem& item = add(SdfItemKind::joint, joint, joint.name(), scope);
  item.pose = read_sdf_pose(joint);
  item.parent = joint.child("parent") ? joint.child("parent").text() : "";
  item.child = joint.child("child") ? joint.child("child").text() : "";
  if (item.parent.empty() || item.child.empty()) joint.fail("lacks a <parent> or a <child>, expected both");
}

void SdfReader::add_model(const SdfElement& model, const SdfElement* include, SdfScope& outer) {
  if (++models_ > kMaxSdfModels) model.fail("is one of more than " + std::to_string(kMaxSdfModels) + " models");
  const auto included = [&](const char* tag) { return include == nullptr ? SdfElement() : include->child(tag); };
  const std::string name = included("name") ? included("name").text() : std::string();
  SdfItem& item = add(SdfItemKind::model, model, name.empty() ? model.name() : name, outer);
  item.pose = read_sdf_pose(included("pose") ? *include : model);
  item.scope = std::make_unique<SdfScope>();
  item.scope->outer = &outer;
  item.scope->item = &item;
  item.scope->canonical_link = model.attribute("canonical_link");
  item.scope->placement_frame = included("placement_frame") ? included("placement_frame").text()
                                                            : std::string(model.attribute("placement_frame"));
  item.scope->is_merged =
      include != nullptr && (include->attribute("merge") == "true" || include->attribute("merge") == "1");
  item.scope->label = label_of(model, include);
  item.scope->is_static = (included("static") ? included("static") : model.child("static")).flag(false);
  std::size_t depth = 0;
  for (const SdfScope* each = &outer; each != nullptr; each = each->outer) ++depth;
  if (depth > kMaxSdfNested) model.fail("is nested deeper than " + std::to_string(kMaxSdfNested) + " models");
  read_scope(model, *item.scope);
}

// What an <include> says stands behind the content of the model.
std::optional<std::uint32_t> SdfReader::label_of(const SdfElement& model, const SdfElement* include) {
  try {
    const std::optional<std::uint32_t> included = include == nullptr ? std::nullopt : sdf_label(*include);
    return included ? included : sdf_label(model);
  } catch (const InputError& error) {
    report_.warn(as_warning(error, "the label is left out"));
    return std::nullopt;
  }
}

void SdfReader::add_light(const SdfElement& light, const SdfElement* include) {
  const std::string name = include != nullptr && include->child("name") ? include->child("name").text() : "";
  content_.lights.push_back({light, name.empty() ? light.name() : name,
                             read_sdf_pose(include != nullptr && include->child("pose") ? *include : light)});
}

void SdfReader::read_include(const SdfElement& include, SdfScope& scope) {
  for (const SdfElement& child : include.children()) {
    if (!is_sdf_label(child)) report_unread(child, report_);
  }
  const std::string uri = include.child("uri") ? include.child("uri").text() : "";
  std::string why;
  const auto path = files_.find_model(uri, include, why);
  if (!path) return report_.warn_once(include.at(), "the <include> is left out, " + why);
  std::error_code error;
  const std::filesystem::path key = std::filesystem::canonical(*path, error);
  if (std::ranges::count(open_, key) > 0) include.fail("makes " + in_quotes(path->string()) + " include itself");
  if (open_.size() >= kMaxSdfNested) include.fail("is nested deeper than " + std::to_string(kMaxSdfNested) + " files");
  SdfFile* file = nullptr;
  try {
    file = &open(*path);
  } catch (const InputError& wrong) {
    return report_.warn(as_warning(wrong, "the <include> at " + to_string(include.at()) + " is left out"));
  }
  open_.push_back(key);
  insert_included(include, root_of(*file), scope);
  open_.pop_back();
}

void SdfReader::insert_included(const SdfElement& include, const SdfElement& root, SdfScope& scope) {
  const bool is_readable = is_sdf_root(root) && root.file().version >= kFirstSdfVersion;
  if (is_readable) {
    if (const SdfElement model = root.child("model")) return add_model(model, &include, scope);
    if (const SdfElement light = root.child("light"); light && scope.outer == nullptr)
      return add_light(light, &include);
    if (const SdfElement actor = root.child("actor")) return report_unread(actor, report_);
  }
  report_.warn(include.at(), "the <include> is left out, " + in_quotes(root.at().file) +
                                 " has no <model> of SDF from version 1.2 on");
}

}  // namespace simvis
