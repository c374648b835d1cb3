#include "import/sdf/sdf_poses.h"

#include <optional>
#include <utility>

#include <simvis/pose.h>

namespace simvis {
namespace {

constexpr int kMaxFrameChain = 1000;  // frames that refer to each other: each takes a place on the stack
constexpr std::string_view kDelimiter = "::";

// Where a name leads: an item of the scope or of a model within it.
struct Found {
  SdfScope* scope;
  SdfItem* item;
};

std::optional<Found> find_sdf_item(SdfScope& scope, std::string_view name) {
  if (const auto known = scope.by_name.find(name); known != scope.by_name.end()) return Found{&scope, known->second};
  for (std::size_t at = name.find(kDelimiter); at != std::string_view::npos; at = name.find(kDelimiter, at + 1)) {
    const auto model = scope.by_name.find(name.substr(0, at));
    if (model == scope.by_name.end() || model->second->scope == nullptr) continue;
    if (const auto found = find_sdf_item(*model->second->scope, name.substr(at + kDelimiter.size()))) return found;
  }
  for (const auto& item : scope.items) {
    if (item->scope == nullptr || !item->scope->is_merged) continue;
    if (const auto found = find_sdf_item(*item->scope, name)) return found;
  }
  return std::nullopt;
}

bool is_scope_itself(const SdfScope& scope, std::string_view name) {
  return name.empty() || name == "__model__" || (scope.outer == nullptr && (name == "world" || name == "__root__"));
}

Found require_item(SdfScope& scope, const std::string& name, const SdfElement& where) {
  if (const auto found = find_sdf_item(scope, name)) return *found;
  std::vector<std::string_view> known;
  for (const auto& [each, item] : scope.by_name) known.push_back(each);
  where.fail("refers to " + in_quotes(name) + ", but there is no such link, frame, joint or model" +
             suggestion(name, known));
}

// The first link of a model, which may lie in a model within it.
SdfItem* first_link(const SdfScope& scope) {
  for (const auto& item : scope.items) {
    if (item->kind == SdfItemKind::link) return item.get();
  }
  for (const auto& item : scope.items) {
    if (item->scope == nullptr) continue;
    if (SdfItem* const link = first_link(*item->scope)) return link;
  }
  return nullptr;
}

}  // namespace

class SdfPoses::Step {
 public:
  Step(int& depth, const SdfElement& where) : depth_(depth) {
    if (++depth_ > kMaxFrameChain) {
      --depth_;
      where.fail("stands in a chain of more than " + std::to_string(kMaxFrameChain) + " frames or a circle of them");
    }
  }
  ~Step() { --depth_; }
  Step(const Step&) = delete;
  Step& operator=(const Step&) = delete;

 private:
  int& depth_;
};

glm::dmat4 SdfPoses::frame(SdfScope& scope, const std::string& name, const SdfElement& where) {
  if (is_scope_itself(scope, name)) return glm::dmat4(1);
  const Step step(depth_, where);
  constexpr std::string_view kScopeOf = "::__model__";  // MODEL::__model__ is MODEL
  if (name.ends_with(kScopeOf)) return frame(scope, name.substr(0, name.size() - kScopeOf.size()), where);
  const Found found = require_item(scope, name, where);
  glm::dmat4 matrix = item(*found.scope, *found.item);
  for (SdfScope* each = found.scope; each != &scope; each = each->outer) {
    matrix = item(*each->outer, *each->item) * matrix;
  }
  return matrix;
}

const glm::dmat4& SdfPoses::item(SdfScope& scope, SdfItem& item) {
  if (item.progress == SdfItem::Progress::known) return item.scope_from_item;
  if (item.progress == SdfItem::Progress::under_way) item.pose.where.fail("depends on itself: frames form a circle");
  const Step step(depth_, item.pose.where);
  item.progress = SdfItem::Progress::under_way;
  const bool follows_child = item.kind == SdfItemKind::joint || item.kind == SdfItemKind::frame;
  glm::dmat4 matrix = pose(scope, item.pose, follows_child ? item.child : std::string());
  if (item.scope != nullptr && !item.scope->placement_frame.empty()) {
    matrix = matrix * rigid_inverse(frame(*item.scope, item.scope->placement_frame, item.pose.where));
  }
  item.scope_from_item = matrix;
  item.progress = SdfItem::Progress::known;
  return item.scope_from_item;
}

glm::dmat4 SdfPoses::scope(SdfScope& scope) {
  glm::dmat4 matrix(1);
  for (SdfScope* each = &scope; each->outer != nullptr; each = each->outer) {
    matrix = item(*each->outer, *each->item) * matrix;
  }
  return matrix;
}

glm::dmat4 SdfPoses::pose(SdfScope& scope, const SdfPose& pose, const std::string& fallback) {
  return frame(scope, pose.relative_to.empty() ? fallback : pose.relative_to, pose.where) * pose.matrix;
}

SdfItem* SdfPoses::link(SdfScope& scope, const std::string& name, const SdfElement& where) {
  if (name == "world" && !find_sdf_item(scope, name)) return nullptr;
  const Step step(depth_, where);
  SdfScope* in = &scope;
  SdfItem* item = scope.item;
  if (!is_scope_itself(scope, name)) {
    const Found found = require_item(scope, name, where);
    in = found.scope;
    item = found.item;
  }
  if (item == nullptr) return nullptr;
  if (item->kind == SdfItemKind::link) return item;
  if (item->kind == SdfItemKind::model) {
    if (!item->scope->canonical_link.empty()) return link(*item->scope, item->scope->canonical_link, where);
    return first_link(*item->scope);
  }
  return link(*in, item->child, where);
}

}  // namespace simvis
