#include "sensors/camera/camera_moment.h"

#include <algorithm>
#include <utility>

#include "engine/base/assert.h"
#include "scenegraph/archived_surfaces.h"
#include "scenegraph/motion_path.h"

namespace simvis {
namespace {

// A scene of a saved state, which no keeper has.
struct ArchivedScene {
  DrawList list;
  KeptScene scene{.list = list, .shape = {}, .moves = {}};
};

void archive_joint(StateArchive& state, ScrewMotion& joint) {
  state.finite(joint.point_m, joint.turn_rad, joint.way_m);
}

void archive_piece(StateArchive& state, MotionPiece& piece) {
  state.finite(piece.begin, piece.end, piece.point_m, piece.until_end.turn, piece.until_end.way_m);
  state.require(piece.begin < piece.end);
  std::size_t joints = piece.joints.size();
  state.count(joints, sizeof(ScrewMotion));
  piece.joints.resize(joints);
  for (ScrewMotion& each : piece.joints) archive_joint(state, each);
}

void archive_move(StateArchive& state, ItemMove& move) {
  MotionPath path = state.is_reading() ? MotionPath() : *move.path;
  std::size_t pieces = path.pieces.size();
  state(move.item);
  state.count(pieces, 2 * sizeof(double));
  state.require(pieces > 0);
  path.pieces.resize(pieces);
  for (MotionPiece& each : path.pieces) archive_piece(state, each);
  if (state.is_reading()) move.path = std::make_shared<const MotionPath>(std::move(path));
}

void archive_scene(StateArchive& state, std::shared_ptr<const KeptScene>& scene) {
  const auto archived = std::make_shared<ArchivedScene>();
  if (!state.is_reading()) {
    archived->list = scene->list;
    archived->scene.shape = scene->shape;
    archived->scene.moves = scene->moves;
  }
  auto& [list, kept] = *archived;
  archive_surfaces(state, list);
  state(kept.shape);
  state.require(kept.shape.size() == list.items.size());
  std::size_t moves = kept.moves.size();
  state.count(moves, sizeof(std::uint32_t));
  kept.moves.resize(moves);
  std::uint64_t next = 0;
  for (ItemMove& each : kept.moves) {
    archive_move(state, each);
    state.require(each.item >= next && each.item < list.items.size());
    next = std::uint64_t{each.item} + 1;
  }
  if (state.is_reading()) scene = {archived, &kept};
}

void archive_moment(StateArchive& state, std::optional<CameraMoment>& moment, const CameraMoment* beside) {
  bool is_there = moment.has_value();
  state(is_there);
  if (!is_there) return moment.reset();
  if (!moment) moment.emplace();
  moment->archive(state, beside == nullptr ? nullptr : beside->scene);
}

}  // namespace

std::shared_ptr<const KeptScene> SceneKeeper::keep(const SensedScene& scene, std::span<const ItemMove> moves) {
  auto free = std::ranges::find_if(kept_, [](const std::shared_ptr<Kept>& each) { return each.use_count() == 1; });
  if (free == kept_.end()) free = kept_.insert(free, std::make_shared<Kept>(layer_));
  Kept& kept = **free;
  kept.list.follow(scene.list);
  kept.scene.shape.assign(scene.shape.begin(), scene.shape.end());
  kept.scene.moves.assign(moves.begin(), moves.end());
  return {*free, &kept.scene};
}

std::uint64_t SceneKeeper::lists_copied() const {
  std::uint64_t copies = 0;
  for (const std::shared_ptr<Kept>& each : kept_) copies += each->list.copies();
  return copies;
}

glm::dmat4 CameraMoment::world_from_mesh(std::size_t of_rows, std::uint32_t item) const {
  const DrawList& list = scene->list;
  const glm::dmat4& world_from_mesh = list.world_from_node[list.items[item].transform];
  const auto move = std::ranges::lower_bound(scene->moves, item, {}, &ItemMove::item);
  if (rows[of_rows].share == 0 || move == scene->moves.end() || move->item != item) return world_from_mesh;
  return place_at(*move->path, rows[of_rows].share, world_from_mesh);
}

std::vector<ItemPlace> CameraMoment::places(std::size_t of_rows) const {
  std::vector<ItemPlace> places;
  if (rows[of_rows].share == 0) return places;
  for (const ItemMove& move : scene->moves) places.push_back({move.item, world_from_mesh(of_rows, move.item)});
  return places;
}

std::size_t CameraMoment::rows_at(double y_px) const {
  SIMVIS_ASSERT(!rows.empty());
  const auto behind = std::ranges::upper_bound(rows, y_px, {}, [](const PosedRows& each) { return each.first; });
  return behind == rows.begin() ? 0 : static_cast<std::size_t>(behind - rows.begin()) - 1;
}

bool RowSearch::next(double y_px) {
  const std::size_t wanted = moment_.rows_at(y_px);
  is_met_ = wanted == rows_;
  if (is_met_) return false;
  (wanted > rows_ ? first_ : end_) = wanted > rows_ ? rows_ + 1 : rows_;
  if (first_ == end_) return false;
  rows_ = std::clamp(wanted, first_, end_ - 1);
  return true;
}

void PosedRows::archive(StateArchive& state) {
  state(first, count);
  state.finite(world_from_view, share);
  state.require(share <= 0);
}

void CameraMoment::archive(StateArchive& state, const std::shared_ptr<const KeptScene>& known) {
  state(time_ns, rows);
  state.require_past(time_ns);
  bool is_known = known != nullptr && scene == known;
  state(is_known);
  if (!is_known) return archive_scene(state, scene);
  state.require(known != nullptr);
  scene = known;
}

void MomentHistory::archive(StateArchive& state, const MomentHistory* beside) {
  archive_moment(state, now_, beside == nullptr ? nullptr : beside->now());
  const bool is_made_again = now_ && now_->time_ns > state.last_ns();
  if (is_made_again) {
    archive_moment(state, before_, beside == nullptr ? nullptr : beside->before());
    state.require(!before_ || before_->time_ns < now_->time_ns);
  } else if (state.is_reading()) {
    before_.reset();
  }
}

void MomentHistory::add(CameraMoment moment) {
  if (now_ && now_->time_ns < moment.time_ns) before_ = std::move(now_);
  now_ = std::move(moment);
}

}  // namespace simvis
