#include <simvis/object_tree.h>

#include <algorithm>
#include <set>
#include <sstream>
#include <utility>

#include <fnmatch.h>

#include <simvis/location.h>
#include "engine/base/assert.h"

namespace simvis {
namespace {

constexpr std::string_view kWorld = "ROOT";
constexpr std::uint32_t kWorldObject = 0;

// The name of an object as its path ends with it: without the name of its parent in front, and without the folders that
// the parent's path begins with too.
std::string_view own_name(const Object& parent, std::string_view name) {
  const std::string inside = parent.name + "/";
  if (name.size() > inside.size() && name.starts_with(inside)) return name.substr(inside.size());
  std::string_view path = parent.path;
  for (std::size_t slash = name.find('/'); slash != name.npos && path.starts_with(name.substr(0, slash + 1));
       slash = name.find('/')) {
    path.remove_prefix(slash + 1);
    name.remove_prefix(slash + 1);
  }
  return name;
}

}  // namespace

std::string_view to_string(ObjectKind kind) {
  constexpr std::string_view kNames[] = {"world", "part", "model", "link", "frame", "shape"};
  return kNames[static_cast<std::size_t>(kind)];
}

bool matches_pattern(std::string_view pattern, std::string_view name) {
  return pattern == name || ::fnmatch(std::string(pattern).c_str(), std::string(name).c_str(), 0) == 0;
}

ObjectTree::ObjectTree() {
  objects_.push_back({.name = std::string(kWorld), .path = std::string(kWorld), .kind = ObjectKind::world});
  by_name_.emplace(kWorld, kWorldObject);
}

std::uint32_t ObjectTree::add(std::string name, ObjectKind kind, std::uint32_t parent) {
  const auto number = static_cast<std::uint32_t>(objects_.size());
  const Object& above = objects_[parent];
  std::string path = parent == kWorldObject ? name : above.path + "/" + std::string(own_name(above, name));
  const bool is_new = by_name_.emplace(name, number).second;
  SIMVIS_ASSERT(is_new);
  by_path_.emplace(path, number);
  const std::uint32_t part = kind == ObjectKind::part ? number : above.part;
  objects_.push_back({.name = std::move(name), .path = std::move(path), .kind = kind, .parent = parent, .part = part});
  return number;
}

std::optional<std::uint32_t> ObjectTree::find(std::string_view name) const {
  if (const auto found = by_name_.find(name); found != by_name_.end()) return found->second;
  const auto [first, end] = by_path_.equal_range(name);
  return first != end && std::next(first) == end ? std::optional(first->second) : std::nullopt;
}

std::vector<std::uint32_t> ObjectTree::matching(std::string_view pattern) const {
  std::vector<std::uint32_t> found;
  for (const auto& [name, object] : by_name_) {
    if (object != kWorldObject && matches_pattern(pattern, name)) found.push_back(object);
  }
  if (!found.empty()) return found;
  for (const auto& [name, object] : by_name_) {
    if (object != kWorldObject && matches_pattern(pattern, objects_[object].path)) found.push_back(object);
  }
  return found;
}

std::vector<std::uint32_t> ObjectTree::named(std::string_view value, std::vector<std::string>& unknown) const {
  std::vector<std::uint32_t> found = matching(value);
  if (!found.empty()) return found;
  std::map<std::string_view, std::uint32_t> by_name;
  std::istringstream words{std::string(value)};
  for (std::string word; words >> word;) {
    const std::vector<std::uint32_t> own = matching(word);
    if (own.empty()) unknown.push_back(word);
    for (const std::uint32_t object : own) by_name.emplace(objects_[object].name, object);
  }
  for (const auto& [name, object] : by_name) found.push_back(object);
  return found;
}

// Parents stand in front of what belongs to them.
std::vector<std::uint32_t> ObjectTree::content_of(std::uint32_t object) const {
  std::vector<std::uint32_t> content{object};
  const ObjectKind kind = objects_[object].kind;
  if (kind != ObjectKind::part && kind != ObjectKind::model) return content;
  std::set<std::uint32_t> inside{object};
  for (std::uint32_t each = object + 1; each < objects_.size(); ++each) {
    if (objects_[each].kind == ObjectKind::part || !inside.contains(objects_[each].parent)) continue;
    inside.insert(each);
    content.push_back(each);
  }
  return content;
}

std::vector<std::string> ObjectTree::names_in(std::uint32_t object) const {
  std::vector<std::string> names;
  for (const std::uint32_t each : content_of(object)) names.push_back(objects_[each].name);
  return names;
}

std::string ObjectTree::unknown(std::string_view noun, std::string_view name) const {
  std::vector<std::string_view> known;
  for (const auto& [path, object] : by_path_) known.push_back(path);
  for (const auto& [each, object] : by_name_) known.push_back(each);
  return "there is no " + std::string(noun) + " " + in_quotes(name) + suggestion(name, known);
}

}  // namespace simvis
