// The state of the physics of a scene between two frames.
#include <algorithm>
#include <map>
#include <string>
#include <type_traits>
#include <utility>

#include "elements/dynamics/dynamic_scene.h"

namespace simvis {

// What has been removed would leave the world at the next advance(), before anything else happens to it.
void DynamicScene::archive(StateArchive& state) {
  if (!state.is_reading() && !state.keeps_all() && !failure_.empty()) state.refuse(failure_);
  if (world_ != nullptr) leave();
  archive_objects(state);
  state(last_ns_, left_ns_, advanced_to_ns_, steps_, runs_, restarts_, failure_);
  state.require(failure_.empty());
  state.require_past(last_ns_);
  state.require(left_ns_ >= 0);
  // No years of steps: more than one are left only of a frame that was interrupted.
  state.require(world_ == nullptr ||
                (last_ns_ >= state.last_ns() && left_ns_ <= step_ns_ + (last_ns_ - state.last_ns())));
  state.require(!advanced_to_ns_ || *advanced_to_ns_ == last_ns_);
  attachments_.archive(state);
  archive_followed(state);
  if (state.is_reading()) wrenches_.forget_bodies();
  if (state.keeps_all()) {
    state(pulls_);
  } else if (state.is_reading()) {
    pulls_.clear();
  }
}

// Objects that stand in the world by other ids than those of the state enter it anew, in the order of these.
void DynamicScene::archive_objects(StateArchive& state) {
  bool has_world = world_ != nullptr;
  std::vector<std::optional<std::size_t>> ids, own;
  for (const DynamicObject* const object : objects_) own.push_back(object->id);
  ids = own;
  std::size_t constraints = constraints_.size(), pairs = pairs_.size();
  state(has_world, ids, constraints, pairs);
  const bool is_same =
      has_world == (world_ != nullptr) && ids == own && constraints == constraints_.size() && pairs == pairs_.size();
  if (state.is_reading() && !is_same) {
    state.require(ids.size() == objects_.size());
    if (has_world) {
      make_world_as(state, ids, constraints, pairs);
    } else {
      state.require(std::ranges::none_of(ids, [](const auto& id) { return id.has_value(); }));
      forget_world();
    }
  }
  if (has_world) world_->archive(state);
}

// Where they stand at first does not count. The first constraints and pairs have joined already.
void DynamicScene::make_world_as(StateArchive& state, const std::vector<std::optional<std::size_t>>& ids,
                                 std::size_t constraints, std::size_t pairs) {
  constexpr std::size_t kMaxIds = std::size_t{1} << 31;
  std::map<std::size_t, DynamicObject*> entering;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (ids[i]) state.require(*ids[i] < kMaxIds && entering.emplace(*ids[i], objects_[i]).second);
  }
  make_world();
  for (const auto& [id, object] : entering) {
    world_->number_from(id);
    object->id = object->enter(*world_, glm::dmat4(1));
    entered_.emplace(id, object);
  }
  const auto may_join = [](const auto& all, std::size_t count) {
    const auto has_entered = [](const auto& each) { return each.a->id && (each.b == nullptr || each.b->id); };
    return count <= all.size() &&
           std::all_of(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count), has_entered);
  };
  state.require(may_join(new_constraints_, constraints) && may_join(new_pairs_, pairs));
  const auto leave_later = [](auto& all, std::size_t first) {
    const auto later = all.begin() + static_cast<std::ptrdiff_t>(first);
    std::decay_t<decltype(all)> left(later, all.end());
    all.erase(later, all.end());
    return left;
  };
  std::vector<DynamicConstraint> later_constraints = leave_later(new_constraints_, constraints);
  std::vector<DynamicPair> later_pairs = leave_later(new_pairs_, pairs);
  join();
  new_constraints_ = std::move(later_constraints);
  new_pairs_ = std::move(later_pairs);
}

// Of the sensors that are on, which are those of the state.
void DynamicScene::archive_followed(StateArchive& state) {
  std::size_t count = followed_.size();
  state.count(count, 1);
  state.require(count == followed_.size());
  for (auto& [point, followed] : followed_) {
    std::string name = point;
    state(name);
    state.require(name == point);
    bool is_there = followed.last.has_value();
    state(is_there);
    if (!is_there) {
      followed.last.reset();
      continue;
    }
    if (!followed.last) followed.last.emplace();
    for (StepMotion::At* const at : {&followed.last->before, &followed.last->after}) {
      state.finite(at->world_from_body, at->center_m, at->velocity_m_s, at->angular_velocity_rad_s);
    }
    state.finite(followed.last->step_s);
  }
}

}  // namespace simvis
