#include "scenegraph/flattener.h"

#include <algorithm>
#include <unordered_set>

#include <simvis/error.h>
#include "engine/base/assert.h"

namespace simvis {

namespace {

// Assigns slots of a DrawList table to pointers, in order of first use.
template <typename T>
class Slots {
 public:
  explicit Slots(std::vector<std::shared_ptr<const T>>& table) : table_(table) {}

  std::uint32_t shared(const std::shared_ptr<const T>& object) {
    const auto [found, is_new] = numbers_.try_emplace(object.get(), static_cast<std::uint32_t>(table_.size()));
    if (is_new) table_.push_back(object);
    return found->second;
  }

  std::uint32_t own(const std::shared_ptr<const T>& object) {
    table_.push_back(object);
    return static_cast<std::uint32_t>(table_.size() - 1);
  }

 private:
  std::vector<std::shared_ptr<const T>>& table_;
  std::unordered_map<const T*, std::uint32_t> numbers_;
};

const std::shared_ptr<const Material>& default_material() {
  static const auto material = std::make_shared<const Material>();
  return material;
}

// As the group of a part is, or of a link, whose point may have a prefix.
bool is_named_after(const Group& group, const Node& point) {
  return point.name == group.name || point.name.ends_with("/" + group.name);
}

}  // namespace

Flattener::Flattener(GroupPtr root, Audience audience) : root_(std::move(root)), audience_(audience) {
  SIMVIS_ASSERT(root_ != nullptr);
}

Flattener::~Flattener() {
  for (const NodePtr& node : attached_) node->detach(*this);
}

void Flattener::content_changed(Node& node) { changed_.push_back(&node); }

void Flattener::structure_changed() { structure_changed_ = true; }

bool Flattener::find_mount(const Mount& mount, glm::dmat4& world_from_mount) const {
  const std::optional<std::uint32_t> transform = transform_of(mount);
  if (transform) world_from_mount = list_.world_from_node[*transform];
  return transform.has_value();
}

std::optional<std::uint32_t> Flattener::transform_of(const Mount& mount) const {
  const auto found = mounts_.find(&mount);
  return found == mounts_.end() ? std::nullopt : std::optional(found->second);
}

void Flattener::watch(std::unordered_set<const Node*> points) {
  if (points == watched_) return;
  watched_ = std::move(points);
  structure_changed_ = true;
}

const Flattener::PointPlace* Flattener::find_point(const Node& point) const {
  const auto found = points_.find(&point);
  return found == points_.end() ? nullptr : &found->second;
}

std::vector<ShapeName> Flattener::names_of(const ItemSource& item) const {
  std::vector<ShapeName> names;
  if (!item.shape->name.empty()) names.push_back({item.shape->name});
  for (std::uint32_t at = item.group; at != 0; at = named_groups_[at].parent) {
    names.push_back({named_groups_[at].group->name, at});
  }
  return names;
}

std::optional<std::uint32_t> Flattener::transform_of(const Node& point) const {
  const auto found = point_entries_.find(&point);
  return found == point_entries_.end() ? std::nullopt : std::optional(found->second);
}

std::optional<glm::dmat4> Flattener::between(std::uint32_t outer, std::uint32_t inner) const {
  glm::dmat4 product(1);
  for (; inner > outer; inner = entries_[inner].parent) product = entries_[inner].node->matrix() * product;
  return inner == outer ? std::optional(product) : std::nullopt;
}

const DrawList& Flattener::update() {
  if (structure_changed_ || changes_lights()) {
    rebuild();
  } else {
    rewrite_changed();
  }
  changed_.clear();
  return list_;
}

void Flattener::rewrite_changed() {
  std::vector<Range> ranges;
  for (const Node* node : changed_) {
    const auto found = occurrences_.find(node);
    if (found == occurrences_.end()) continue;
    if (node == environment_node_) list_.environment = environment_node_->environment();
    if (node == sky_node_) list_.sky.factor = sky_node_->view().factor;
    if (node == medium_node_) list_.medium = medium_node_->medium();
    for (const std::uint32_t slot : found->second) {
      switch (node->kind()) {
        case NodeKind::transform:
          ranges.push_back({slot, entries_[slot].end});
          break;
        case NodeKind::material:
          list_.materials[slot] = static_cast<const MaterialNode*>(node)->shown();
          list_.material_revision[slot] = ++list_.revisions.materials;
          ++counters_.materials_written;
          break;
        case NodeKind::light:
          list_.lights[slot].light = static_cast<const LightNode*>(node)->shown();
          ++list_.revisions.lights;
          ++counters_.lights_written;
          break;
        case NodeKind::shape:
          rewrite_mesh(static_cast<const Shape&>(*node), slot);
          break;
        case NodeKind::visibility:
          rewrite_visibility(visibilities_[slot].items);
          break;
        default:
          SIMVIS_ASSERT(!"nodes of this kind have no content");
      }
    }
  }
  if (!ranges.empty()) rewrite_transforms(ranges);
}

// Whether a visibility has changed that governs lights.
bool Flattener::changes_lights() const {
  return std::ranges::any_of(changed_, [this](const Node* node) {
    const auto found = occurrences_.find(node);
    if (node->kind() != NodeKind::visibility || found == occurrences_.end()) return false;
    return std::ranges::any_of(found->second, [this](std::uint32_t entry) { return visibilities_[entry].has_lights; });
  });
}

bool Flattener::is_visible(std::uint32_t visibility) const {
  while (visibility != 0 && visibilities_[visibility].node->visible()) visibility = visibilities_[visibility].parent;
  return visibility == 0;
}

void Flattener::rewrite_mesh(const Shape& shape, std::uint32_t slot) {
  list_.meshes[slot] = shape.mesh();
  ++list_.revisions.structure;
  for (const std::uint32_t item : items_of_.at(&shape)) list_.changes.mark_item_dirty(item);
  ++counters_.meshes_written;
}

void Flattener::rewrite_visibility(const Range& items) {
  for (std::uint32_t item = items.first; item < items.end; ++item) {
    const bool visible = is_visible(visibility_of_[item]);
    if (visible == list_.items[item].visible) continue;
    list_.items[item].visible = visible;
    list_.changes.mark_item_dirty(item);
    ++counters_.items_shown_or_hidden;
  }
  ++list_.revisions.structure;
}

void Flattener::rewrite_transforms(std::vector<Range>& ranges) {
  // Ranges are nested or disjoint. Sorted by their starts, each entry is written once.
  std::ranges::sort(ranges, {}, &Range::first);
  std::uint32_t next = 0;
  for (const Range& range : ranges) {
    for (std::uint32_t e = std::max(range.first, next); e < range.end; ++e) {
      list_.world_from_node[e] = list_.world_from_node[entries_[e].parent] * entries_[e].node->matrix();
      ++counters_.transforms_written;
    }
    if (range.end <= next) continue;
    list_.changes.mark_transforms_dirty({std::max(range.first, next), range.end});
    next = range.end;
  }
  ++list_.revisions.transforms;
}

void Flattener::forget() {
  for (const NodePtr& node : attached_) node->detach(*this);
  attached_.clear();
  occurrences_.clear();
  mounts_.clear();
  points_.clear();
  point_entries_.clear();
  environment_node_ = nullptr;
  list_.environment = Environment();
  sky_node_ = nullptr;
  list_.sky = SkyView();
  medium_node_ = nullptr;
  list_.medium = Medium();
  entries_.assign(1, Entry{nullptr, 0, 0});
  visibilities_.assign(1, VisibilityEntry{nullptr, 0, {0, 0}, false});
  named_groups_.assign(1, NamedGroup{nullptr, 0});
  visibility_of_.clear();
  items_of_.clear();
  list_.changes.mark_structure_dirty();
  list_.items.clear();
  item_sources_.clear();
  list_.lights.clear();
  list_.world_from_node.assign(1, glm::dmat4(1.0));
  list_.meshes.clear();
  list_.materials.clear();
}

// One traversal of the whole graph that fills the empty tables of a flattener.
class Flattener::Traversal {
 public:
  explicit Traversal(Flattener& flattener) : f_(flattener), meshes_(f_.list_.meshes), materials_(f_.list_.materials) {}

  void run() {
    enter(f_.root_);
    while (!path_.empty()) {
      Level& level = path_.back();
      if (level.next == level.end) {
        leave();
      } else {
        visit(level.group->children()[level.next++]);
      }
    }
  }

 private:
  // The state that passes from node to node. A separator restores it.
  struct State {
    std::uint32_t entry = 0;                      // entry of world_from_node in force
    const MaterialNode* material_node = nullptr;  // in force; null: the default material
    const InsertionPoint* point = nullptr;        // the last one before this node
    std::uint32_t visibility = 0;                 // entry of visibilities_ in force
    std::uint32_t group = 0;                      // entry of named_groups_: the innermost one
  };

  // A group on the path from the root to the current node.
  struct Level {
    const Group* group;
    std::size_t next, end;  // children still to visit
    State saved;
    std::size_t open, open_visibilities;  // numbers of entries without a known end when the group began
    std::uint32_t first_item;
    std::vector<PointPlace*> points{};  // that it has itself
  };

  void visit(const NodePtr& node) {
    ++f_.counters_.nodes_visited;
    switch (node->kind()) {
      case NodeKind::group:
      case NodeKind::separator:
      case NodeKind::switch_:
        enter(node);
        break;
      case NodeKind::visual:
        if (f_.audience_ == Audience::people) enter(node);
        break;
      case NodeKind::visibility:
        add_visibility(node);
        break;
      case NodeKind::environment:
        occurrences_of(node);
        f_.environment_node_ = static_cast<const EnvironmentNode*>(node.get());
        f_.list_.environment = f_.environment_node_->environment();
        break;
      case NodeKind::sky:
        occurrences_of(node);
        f_.sky_node_ = static_cast<const SkyNode*>(node.get());
        f_.list_.sky = f_.sky_node_->view();
        f_.list_.sky.transform = state_.entry;
        break;
      case NodeKind::medium:
        occurrences_of(node);
        f_.medium_node_ = static_cast<const MediumNode*>(node.get());
        f_.list_.medium = f_.medium_node_->medium();
        break;
      case NodeKind::transform:
        add_transform(node);
        break;
      case NodeKind::material:
        occurrences_of(node);
        state_.material_node = static_cast<const MaterialNode*>(node.get());
        break;
      case NodeKind::shape:
        occurrences_of(node);
        add_item(node);
        break;
      case NodeKind::light:
        occurrences_of(node);
        add_light(node);
        break;
      case NodeKind::mount:
        f_.mounts_.try_emplace(static_cast<const Mount*>(node.get()), state_.entry);
        break;
      case NodeKind::insertion_point:
        state_.point = static_cast<const InsertionPoint*>(node.get());
        state_.group = is_named_after(*path_.back().group, *node) ? 0 : named_group(*path_.back().group, 0);
        f_.point_entries_.try_emplace(node.get(), state_.entry);
        if (f_.watched_.contains(node.get())) add_point(*node);
        break;
    }
  }

  // Addresses of the map's values stay the same.
  void add_point(const Node& node) {
    const auto [found, is_new] = f_.points_.try_emplace(&node);
    if (!is_new) return;
    found->second = {state_.entry, path_.back().first_item, item_count()};
    path_.back().points.push_back(&found->second);
  }

  std::uint32_t item_count() const { return static_cast<std::uint32_t>(f_.list_.items.size()); }

  void enter(const NodePtr& node) {
    const auto& group = static_cast<const Group&>(*node);
    if (!on_path_.insert(&group).second) {
      throw InputError("the scene graph has a cycle: the group \"" + group.name + "\" stands below itself");
    }
    occurrences_of(node);
    Level level{&group, 0, group.children().size(), state_, open_.size(), open_visibilities_.size(), item_count()};
    if (group.kind() == NodeKind::switch_) {
      const int which = static_cast<const Switch&>(group).which();
      if (which == Switch::kNone) level.end = 0;
      if (which >= 0) {
        level.next = static_cast<std::size_t>(which);
        level.end = level.next + 1;
      }
    }
    path_.push_back(std::move(level));
    state_.group = named_group(group, state_.group);
  }

  // The entry of a group below the entry `around`; `around` itself if the group has no name.
  std::uint32_t named_group(const Group& group, std::uint32_t around) {
    if (group.name.empty()) return around;
    f_.named_groups_.push_back({&group, around});
    return static_cast<std::uint32_t>(f_.named_groups_.size() - 1);
  }

  void leave() {
    const Level level = std::move(path_.back());
    path_.pop_back();
    for (PointPlace* const point : level.points) point->end_item = item_count();
    on_path_.erase(level.group);
    const NodeKind kind = level.group->kind();
    if (kind != NodeKind::separator && kind != NodeKind::visual && !path_.empty()) {
      state_.group = level.saved.group;
      return;
    }
    for (; open_.size() > level.open; open_.pop_back()) {
      f_.entries_[open_.back()].end = static_cast<std::uint32_t>(f_.entries_.size());
    }
    for (; open_visibilities_.size() > level.open_visibilities; open_visibilities_.pop_back()) {
      f_.visibilities_[open_visibilities_.back()].items.end = item_count();
    }
    state_ = level.saved;
  }

  void add_transform(const NodePtr& node) {
    const auto& transform = static_cast<const Transform&>(*node);
    const auto entry = static_cast<std::uint32_t>(f_.entries_.size());
    occurrences_of(node).push_back(entry);
    f_.entries_.push_back({&transform, state_.entry, 0});
    f_.list_.world_from_node.push_back(f_.list_.world_from_node[state_.entry] * transform.matrix());
    open_.push_back(entry);
    state_.entry = entry;
  }

  void add_visibility(const NodePtr& node) {
    const auto entry = static_cast<std::uint32_t>(f_.visibilities_.size());
    occurrences_of(node).push_back(entry);
    f_.visibilities_.push_back(
        {static_cast<const Visibility*>(node.get()), state_.visibility, {item_count(), item_count()}, false});
    open_visibilities_.push_back(entry);
    state_.visibility = entry;
  }

  void add_item(const NodePtr& node) {
    const auto* const shape = static_cast<const Shape*>(node.get());
    if (shape->has_own_slot()) f_.items_of_[shape].push_back(item_count());
    f_.list_.items.push_back({mesh_slot(node), material_slot(), state_.entry, f_.is_visible(state_.visibility)});
    f_.item_sources_.push_back({state_.point, shape, state_.material_node, state_.group});
    f_.visibility_of_.push_back(state_.visibility);
  }

  void add_light(const NodePtr& node) {
    for (std::uint32_t v = state_.visibility; v != 0; v = f_.visibilities_[v].parent) {
      f_.visibilities_[v].has_lights = true;
    }
    if (!f_.is_visible(state_.visibility)) return;
    occurrences_of(node).push_back(static_cast<std::uint32_t>(f_.list_.lights.size()));
    f_.list_.lights.push_back({static_cast<const LightNode&>(*node).shown(), state_.entry});
  }

  std::uint32_t mesh_slot(const NodePtr& node) {
    const auto& shape = static_cast<const Shape&>(*node);
    if (!shape.has_own_slot()) return meshes_.shared(shape.mesh());
    std::vector<std::uint32_t>& slots = f_.occurrences_.at(&shape);
    if (slots.empty()) slots.push_back(meshes_.own(shape.mesh()));
    return slots.front();
  }

  std::uint32_t material_slot() {
    const MaterialNode* node = state_.material_node;
    if (node == nullptr) return materials_.shared(default_material());
    if (!node->has_own_slot()) return materials_.shared(node->shown());
    std::vector<std::uint32_t>& slots = f_.occurrences_.at(node);
    if (slots.empty()) slots.push_back(materials_.own(node->shown()));
    return slots.front();
  }

  // Returns the list of this node's entries or slots. The first call attaches the flattener as the node's observer.
  std::vector<std::uint32_t>& occurrences_of(const NodePtr& node) {
    const auto [found, is_new] = f_.occurrences_.try_emplace(node.get());
    if (is_new) {
      f_.attached_.push_back(node);
      node->attach(f_);
    }
    return found->second;
  }

  Flattener& f_;
  Slots<Mesh> meshes_;
  Slots<Material> materials_;
  State state_;
  std::vector<Level> path_;
  // Entries of transforms and visibilities without a known end, which govern the next nodes.
  std::vector<std::uint32_t> open_, open_visibilities_;
  std::unordered_set<const Group*> on_path_;
};

void Flattener::rebuild() {
  forget();
  Traversal(*this).run();
  ++counters_.rebuilds;
  structure_changed_ = false;
  ++list_.revisions.structure;
  ++list_.revisions.transforms;
  ++list_.revisions.lights;
  ++list_.revisions.materials;
  list_.material_revision.assign(list_.materials.size(), list_.revisions.materials);
}

}  // namespace simvis
