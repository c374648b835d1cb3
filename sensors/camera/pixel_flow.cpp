#include "sensors/camera/pixel_flow.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/assert.h"
#include "sensors/camera/camera_outputs.h"

namespace simvis {
namespace {

constexpr float kNoFlow = std::numeric_limits<float>::quiet_NaN();
constexpr std::uint8_t kSeen = 0, kNotSeen = 1;

// One output of each view.
struct FlowOutput {
  const char *name, *unit, *frame, *meaning, *when;
  bool FlowDesc::*wanted;
  bool FlowDesc::*and_wanted;
  std::uint32_t channels;
  ValueType type;
  double nothing;
};

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

constexpr FlowOutput kFlowOutputs[] = {
    {"flow_backward", "px", "", "way of the pixel's point to its place in the previous image; x right, y down",
     "flow_backward", &FlowDesc::backward, &FlowDesc::backward, 2, ValueType::f32, kNan},
    {"flow_forward", "px", "", "way of the points of the previous image to their places in this one, by its pixels",
     "flow_forward", &FlowDesc::forward, &FlowDesc::forward, 2, ValueType::f32, kNan},
    {"scene_flow", "m", "optical", "way of the pixel's point in the world since the previous image", "scene_flow",
     &FlowDesc::scene, &FlowDesc::scene, 3, ValueType::f32, kNan},
    {"occlusion_backward", "", "", "1: the pixel's point is not seen in the previous image",
     "occlusion and flow_backward", &FlowDesc::occlusion, &FlowDesc::backward, 1, ValueType::u8, kNotSeen},
    {"occlusion_forward", "", "", "1: the point of the previous image is not seen in this one, by its pixels",
     "occlusion and flow_forward", &FlowDesc::occlusion, &FlowDesc::forward, 1, ValueType::u8, kNotSeen},
};

bool is_wanted(const FlowOutput& output, const FlowDesc& desc) {
  return desc.*output.wanted && desc.*output.and_wanted;
}

// A point passes the poses of two views and of its object, one product of matrices each: some 32 roundings of sums of
// three products, in which no number is larger than all distances together.
constexpr double kFollowRounding = 64 * 0x1p-53;

template <typename T>
void start(SharedArray<T>& image, std::size_t count, T value) {
  image.overwrite().assign(count, value);
}

// How far from the world's origin the view of some rows is, plus how far an item is from it. Neighbouring pixels show
// the same item.
class WorldDistances {
 public:
  explicit WorldDistances(const CameraMoment& moment) : moment_(moment) {}

  double of(std::size_t rows, std::uint32_t item) {
    if (rows == rows_ && item == item_) return distance_m_;
    rows_ = rows;
    item_ = item;
    distance_m_ = glm::length(glm::dvec3(moment_.rows[rows].world_from_view[3]));
    if (item != kNoItem) distance_m_ += glm::length(glm::dvec3(moment_.world_from_mesh(rows, item)[3]));
    return distance_m_;
  }

 private:
  const CameraMoment& moment_;
  std::size_t rows_ = ~std::size_t{0};  // of distance_m_
  std::uint32_t item_ = kNoItem;        // the same
  double distance_m_ = 0;
};

// The flows that the words of `outputs` ask for.
FlowDesc asked_flow(const AttributeValues& attributes) {
  const auto asks = [&](const char* word) { return attributes.flag("outputs", word); };
  return {.backward = asks("flow_backward"),
          .forward = asks("flow_forward"),
          .scene = asks("scene_flow"),
          .occlusion = asks("occlusion"),
          .outputs_at = attributes.where("outputs")};
}

}  // namespace

FlowDesc flow_desc(const AttributeValues& attributes) {
  const FlowDesc desc = asked_flow(attributes);
  if (desc.occlusion && !desc.backward && !desc.forward) {
    fail_at(desc.outputs_at,
            "attribute \"outputs\": occlusion is that of a flow, expected flow_backward or flow_forward beside it");
  }
  return desc;
}

std::vector<OutputSpec> flow_outputs(const std::string& prefix, const AttributeValues& attributes) {
  std::vector<OutputSpec> outputs;
  const FlowDesc desc = asked_flow(attributes);
  for (const FlowOutput& output : kFlowOutputs) {
    outputs.push_back({.name = prefix + output.name,
                       .kind = OutputKind::image,
                       .value_type = output.type,
                       .shape = image_shape(attributes, output.channels),
                       .unit = output.unit,
                       .frame = output.frame,
                       .meaning = output.meaning,
                       .nothing = output.nothing,
                       .when = std::string(output.when) + " among outputs",
                       .given = is_wanted(output, desc)});
  }
  return outputs;
}

PixelFlow::PixelFlow(const FlowDesc& desc, const CameraLayout& layout, const CameraViews& views, double near_m)
    : desc_(desc), layout_(layout), views_(views), near_m_(near_m) {
  if (layout.rays.empty() || layout.pixel_of != nullptr) return;
  fail_at(desc.outputs_at,
          "attribute \"outputs\": an effect of this camera does not say where its lens shows a direction, so there is "
          "no flow; expected another effect, or outputs without flow");
}

void PixelFlow::archive(StateArchive& state, const PixelFlow* beside) {
  history_.archive(state, beside == nullptr ? nullptr : &beside->history_);
  for (const CameraMoment* const each : {history_.now(), history_.before()}) {
    if (each != nullptr) require_rows(state, *each);
  }
  if (desc_.forward) {
    archive(state, drawn_);
    archive(state, drawn_before_);
  }
  if (!state.is_reading()) return;
  backward_.reset();
  forward_.reset();
  skipped_ns_ = seen_ns_ = seen_before_ns_ = kNever;
}

void PixelFlow::require_rows(const StateArchive& state, const CameraMoment& moment) const {
  auto next = moment.rows.begin();
  std::uint32_t next_row = 0;
  for (const CameraView& view : views_.views) {
    if (view.first_row < next_row) continue;
    next_row = view.first_row + view.rows;
    state.require(next != moment.rows.end() && next->first == view.first_row && next->count == view.rows);
    if (next != moment.rows.end()) ++next;
  }
  state.require(next == moment.rows.end());
}

// The moment of the state that has this time; null: there is none.
const CameraMoment* PixelFlow::compared(const StateArchive& state, std::int64_t time_ns) const {
  const CameraMoment *const now = history_.now(), *const before = history_.before();
  if (now == nullptr || now->time_ns == time_ns) return now;
  return now->time_ns > state.last_ns() && before != nullptr && before->time_ns == time_ns ? before : nullptr;
}

void PixelFlow::archive(StateArchive& state, DrawnPoints& drawn) const {
  bool is_there = compared(state, drawn.time_ns) != nullptr;
  state(is_there);
  if (!is_there) {
    if (state.is_reading()) drawn.time_ns = kNever;
    return;
  }
  state(drawn.time_ns, drawn.depth_m, drawn.item);
  const CameraMoment* const moment = compared(state, drawn.time_ns);
  const std::size_t pixels = std::size_t{layout_.width_px} * layout_.height_px;
  state.require(moment != nullptr && drawn.depth_m.size() == pixels && drawn.item.size() == pixels);
  for (std::size_t pixel = 0; pixel < drawn.item.size() && state.is_reading(); ++pixel) {
    state.require(drawn.item[pixel] == kNoItem || drawn.item[pixel] < moment->scene->list.items.size());
    state.require(drawn.item[pixel] == kNoItem || std::isfinite(drawn.depth_m[pixel]));
  }
}

void PixelFlow::begin(CameraMoment now) {
  history_.add(std::move(now));
  const std::size_t pixels = std::size_t{layout_.width_px} * layout_.height_px;
  if (desc_.backward) start(flow_backward_, 2 * pixels, kNoFlow);
  if (desc_.forward) start(flow_forward_, 2 * pixels, kNoFlow);
  if (desc_.scene) start(scene_flow_, 3 * pixels, kNoFlow);
  if (desc_.occlusion && desc_.backward) start(occlusion_backward_, pixels, kNotSeen);
  if (desc_.occlusion && desc_.forward) start(occlusion_forward_, pixels, kNotSeen);
  left_open_.clear();
  backward_.reset();
  forward_.reset();
  if (history_.before() == nullptr) return;
  if (desc_.backward || desc_.scene) {
    backward_.emplace(Direction{.points = PointFlow(layout_, *history_.now(), *history_.before()),
                                .from = *history_.now(),
                                .to = *history_.before(),
                                .flow = desc_.backward ? &flow_backward_ : nullptr,
                                .occlusion = desc_.backward && desc_.occlusion ? &occlusion_backward_ : nullptr,
                                .scene = desc_.scene ? &scene_flow_ : nullptr});
  }
  if (!desc_.forward) return;
  forward_.emplace(Direction{.points = PointFlow(layout_, *history_.before(), *history_.now()),
                             .from = *history_.before(),
                             .to = *history_.now(),
                             .flow = &flow_forward_,
                             .occlusion = desc_.occlusion ? &occlusion_forward_ : nullptr,
                             .scene = nullptr});
}

void PixelFlow::plan(const std::string& name, bool drawn, FramePlan& plan) const {
  if (history_.before() == nullptr) return;
  const std::uint64_t pixels = std::uint64_t{layout_.width_px} * layout_.height_px;
  const auto add = [&](const std::string& reason) {
    plan.casts.push_back({.name = name, .reason = reason, .max_rays = pixels});
  };
  for (const std::optional<Direction>* const direction : {&backward_, &forward_}) {
    if (!drawn || !*direction || !(*direction)->points.any_deforms()) continue;
    add("the pixels of " + name + " on meshes that change their shape, for flow");
  }
  if (forward_ && (drawn ? lacks_drawn() : lacks_cast())) {
    add("the centre of each pixel of " + name + " in its previous frame, which was skipped, for flow");
  }
  if (desc_.occlusion && desc_.backward) add("from the previous place of " + name + " to the points of its pixels");
  if (desc_.occlusion && desc_.forward) add("from " + name + " to the points of its previous image");
}

// Whether no kept image has the pixels of the previous one. Before an image is made, the last one that was made is
// `drawn_` or `seen_`.
bool PixelFlow::lacks_drawn() const {
  const std::int64_t before_ns = forward_->from.time_ns;
  return skipped_ns_ != forward_->to.time_ns && drawn_.time_ns != before_ns && drawn_before_.time_ns != before_ns;
}

bool PixelFlow::lacks_cast() const {
  const std::int64_t before_ns = forward_->from.time_ns;
  return seen_ns_ != before_ns && seen_before_ns_ != before_ns;
}

void PixelFlow::start_drawn() {
  if (drawn_.time_ns == history_.now()->time_ns) return;
  std::swap(drawn_, drawn_before_);
  drawn_.time_ns = history_.now()->time_ns;
  const std::size_t pixels = std::size_t{layout_.width_px} * layout_.height_px;
  drawn_.depth_m.resize(pixels);
  drawn_.item.resize(pixels);
}

// Of a drawn pixel the depth is known, and what a ray through its centre would have given otherwise.
void PixelFlow::read(const Pass& pass, const View& view, const PassResult& result, std::size_t rows) {
  if (desc_.forward) start_drawn();
  const Written images = backward_ ? written(*backward_) : Written{};
  const Pinhole& p = view.pinhole;
  const std::size_t first_row = history_.now()->rows[rows].first;
  for (std::uint32_t row = 0; row < view.height_px; ++row) {
    const std::size_t from = std::size_t{view.y_px + row} * pass.width_px + view.x_px,
                      to = (first_row + row) * layout_.width_px;
    const double ty = (row + 0.5 - p.cy_px) / p.fy_px, y = static_cast<double>(first_row + row) + 0.5;
    for (std::uint32_t column = 0; column < view.width_px; ++column) {
      const double d = result.depth[from + column], tx = (column + 0.5 - p.cx_px) / p.fx_px;
      ImagePoint point{.rows = rows, .point = {tx, ty, 1, 0}};
      if (d > 0) {
        const double z = view.near_m / d;
        point.item = result.item_of(from + column);
        point.point = {tx * z, ty * z, z, 1};
      }
      if (desc_.forward) keep_drawn(to + column, point);
      if (!backward_) continue;
      if (point.item != kNoItem && backward_->points.deforms(point.item)) {
        left_open_.push_back(static_cast<std::uint32_t>(to + column));
        continue;
      }
      set(*backward_, images, {to + column, {column + 0.5, y}}, point, backward_->points.place(point));
    }
  }
}

PixelFlow::Written PixelFlow::written(const Direction& direction) {
  return {direction.flow == nullptr ? nullptr : direction.flow->edit().data(),
          direction.scene == nullptr ? nullptr : direction.scene->edit().data()};
}

void PixelFlow::set(Direction& direction, const Written& images, const FlowPixel& pixel, const ImagePoint& point,
                    const std::optional<glm::dvec2>& place) {
  if (images.flow != nullptr) {
    const glm::dvec2 way_px = place ? *place - pixel.centre : glm::dvec2(kNan);
    for (int c = 0; c < 2; ++c)
      images.flow[2 * pixel.number + static_cast<std::size_t>(c)] = static_cast<float>(way_px[c]);
  }
  if (images.scene == nullptr) return;
  glm::dvec3 way_m(kNan);
  if (point.item != kNoItem) {
    // The way leads to the previous image, and scene flow from it.
    const glm::dmat3 view_from_world = glm::transpose(glm::dmat3(direction.from.rows[point.rows].world_from_view));
    way_m = view_from_world * -direction.points.way_m(point);
  }
  for (int c = 0; c < 3; ++c)
    images.scene[3 * pixel.number + static_cast<std::size_t>(c)] = static_cast<float>(way_m[c]);
}

void PixelFlow::set(std::span<const std::uint32_t> pixels, std::size_t rows, std::span<const glm::dvec3> directions,
                    std::span<const SeenSurface> seen) {
  if (desc_.forward) {
    for (const std::uint32_t pixel : pixels) {
      drawn_.item[pixel] = seen[pixel].item;
      drawn_.depth_m[pixel] = seen[pixel].range_m * directions[pixel].z;
    }
  }
  if (!backward_) return;
  const Written images = written(*backward_);
  for (const std::uint32_t pixel : pixels) follow(*backward_, images, rows, pixel, directions[pixel], seen[pixel]);
}

void PixelFlow::complete_drawn(unsigned threads) {
  if (!forward_ || skipped_ns_ == forward_->to.time_ns) return;
  const bool was_drawn = !lacks_drawn();
  left_open_.clear();
  const Written images = written(*forward_);
  const Pinhole& p = layout_.pinhole;
  for (std::size_t rows = 0; rows < forward_->from.rows.size(); ++rows) {
    const PosedRows& posed = forward_->from.rows[rows];
    for (std::uint32_t row = posed.first; row < posed.first + posed.count; ++row) {
      const double y = row + 0.5, ty = (y - p.cy_px) / p.fy_px;
      const std::size_t first = std::size_t{row} * layout_.width_px;
      for (std::uint32_t column = 0; column < layout_.width_px; ++column) {
        const std::size_t pixel = first + column;
        const double x = column + 0.5, tx = (x - p.cx_px) / p.fx_px;
        ImagePoint point{.rows = rows, .point = {tx, ty, 1, 0}};
        if (was_drawn) point.item = drawn_before_.item[pixel];
        if (!was_drawn || (point.item != kNoItem && forward_->points.deforms(point.item))) {
          left_open_.push_back(static_cast<std::uint32_t>(pixel));
          continue;
        }
        if (point.item != kNoItem) {
          const double z = drawn_before_.depth_m[pixel];
          point.point = {tx * z, ty * z, z, 1};
        }
        set(*forward_, images, {pixel, {x, y}}, point, forward_->points.place(point));
      }
    }
  }
  if (!left_open_.empty()) cast_left_open(threads);
}

// The points of the previous image that complete_drawn() has left open.
void PixelFlow::cast_left_open(unsigned threads) {
  const CameraMoment& before = forward_->from;
  if (!own_rays_) own_rays_.emplace(layout_, views_, near_m_);
  const Written images = written(*forward_);
  before_world_.set(before.scene->list);
  seen_before_.resize(own_rays_->directions().size());
  for (std::size_t r = 0; r < before.rows.size(); ++r) {
    const PosedRows& rows = before.rows[r];
    const auto begin = std::ranges::lower_bound(left_open_, rows.first * layout_.width_px),
               end = std::ranges::lower_bound(left_open_, (rows.first + rows.count) * layout_.width_px);
    const std::span<const std::uint32_t> pixels(begin, end);
    if (pixels.empty()) continue;
    own_rays_->begin(before_world_.place(before.places(r), threads));
    own_rays_->cast(before_world_.caster(), {rows.first, rows.count, rows.world_from_view, {}}, pixels, seen_before_);
    for (const std::uint32_t pixel : pixels) {
      follow(*forward_, images, r, pixel, own_rays_->directions()[pixel], seen_before_[pixel]);
    }
  }
}

FollowedPoint PixelFlow::follow(Direction& direction, const Written& images, std::size_t rows, std::size_t pixel,
                                const glm::dvec3& ray, const SeenSurface& surface) {
  ImagePoint point{.rows = rows, .item = surface.item, .primitive = surface.primitive, .point = {ray, 0}};
  if (surface.item != kNoItem) point.point = {surface.range_m * ray, 1};
  const FollowedPoint followed = direction.points.follow(point);
  const std::size_t row = pixel / layout_.width_px, column = pixel % layout_.width_px;
  const glm::dvec2 centre(static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5);
  set(direction, images, {pixel, centre}, point, followed.pixel);
  return followed;
}

void PixelFlow::cast(RayCaster& caster, const DrawList& list, PixelRays& rays, std::vector<SeenSurface>& seen) {
  SIMVIS_ASSERT(history_.now() != nullptr);
  if (seen_ns_ != history_.now()->time_ns) {
    std::swap(seen_before_, seen_);
    seen_before_ns_ = std::exchange(seen_ns_, history_.now()->time_ns);
  }
  std::swap(seen_, seen);
  if (history_.before() == nullptr) return;
  if (backward_) {
    follow_all(*backward_, rays.directions(), seen_);
    look_back(*backward_, caster.threads());
  }
  if (!forward_) return;
  if (seen_before_ns_ != forward_->from.time_ns) cast_before(forward_->from, rays, caster.threads());
  follow_all(*forward_, rays.directions(), seen_before_);
  look_ahead(*forward_, caster, list);
}

// What a skipped image would have seen.
void PixelFlow::cast_before(const CameraMoment& before, PixelRays& rays, unsigned threads) {
  seen_before_.assign(std::size_t{layout_.width_px} * layout_.height_px, {});
  before_world_.set(before.scene->list);
  for (std::size_t r = 0; r < before.rows.size(); ++r) {
    const PosedRows& rows = before.rows[r];
    rays.begin(before_world_.place(before.places(r), threads));
    rays.cast(before_world_.caster(), {rows.first, rows.count, rows.world_from_view, {}}, seen_before_);
  }
  seen_before_ns_ = before.time_ns;
}

void PixelFlow::follow_all(Direction& direction, std::span<const glm::dvec3> directions,
                           std::span<const SeenSurface> seen) {
  sights_.resize(direction.to.rows.size());
  for (std::vector<Sight>& each : sights_) each.clear();
  const Written images = written(direction);
  WorldDistances from(direction.from), to(direction.to);
  for (std::size_t r = 0; r < direction.from.rows.size(); ++r) {
    const PosedRows& rows = direction.from.rows[r];
    for_tiled_pixels(rows.first, rows.count, layout_.width_px, [&](std::uint32_t pixel) {
      if (directions[pixel] == glm::dvec3(0)) return;
      const FollowedPoint followed = follow(direction, images, r, pixel, directions[pixel], seen[pixel]);
      if (direction.occlusion == nullptr) return;
      const double own_m = seen[pixel].item == kNoItem ? 0 : seen[pixel].error_bound_m;
      if (std::optional<Sight> sight = sight_of(followed, pixel)) {
        const double distances_m = from.of(r, seen[pixel].item) + sight->range_m + to.of(followed.rows, followed.item);
        sight->error_bound_m = own_m + kFollowRounding * distances_m;
        sights_[followed.rows].push_back(*sight);
      }
    });
  }
}

// Empty: the point lies beyond the image, or nearer than anything that is seen.
std::optional<PixelFlow::Sight> PixelFlow::sight_of(const FollowedPoint& followed, std::size_t pixel) const {
  if (!followed.exists || !followed.in_rows) return std::nullopt;
  const glm::dvec2 at = *followed.pixel;
  if (!(at.x >= 0 && at.y >= 0 && at.x < layout_.width_px && at.y < layout_.height_px)) return std::nullopt;
  const glm::dvec3 towards(followed.point);
  const double length = glm::length(towards);
  if (length == 0) return std::nullopt;
  const bool sky = followed.item == kNoItem;
  Sight sight{.pixel = static_cast<std::uint32_t>(pixel), .item = followed.item, .direction = towards / length};
  sight.range_m = sky ? std::numeric_limits<double>::infinity() : length;
  double along = sight.direction.z;  // of the axis that `near` is measured along
  if (!views_.taps.empty()) {
    const PixelTap& tap =
        views_.taps[static_cast<std::size_t>(at.y) * layout_.width_px + static_cast<std::size_t>(at.x)];
    if (tap.view == PixelTap::kNone) return std::nullopt;
    along = (views_.views[tap.view].face_from_view * sight.direction).z;
  }
  if (along <= 0) return std::nullopt;
  sight.behind_m = near_m_ / along;
  if (sight.range_m <= sight.behind_m) return std::nullopt;
  return sight;
}

void PixelFlow::look_back(Direction& direction, unsigned threads) {
  if (direction.occlusion == nullptr) return;
  before_world_.set(direction.to.scene->list);
  for (std::size_t r = 0; r < sights_.size(); ++r) {
    if (sights_[r].empty()) continue;
    const DrawList& world = before_world_.place(direction.to.places(r), threads);
    look(direction, r, before_world_.caster(), world);
  }
}

void PixelFlow::look_ahead(Direction& direction, RayCaster& caster, const DrawList& list) {
  if (direction.occlusion == nullptr) return;
  now_world_.set(list);
  for (std::size_t r = 0; r < sights_.size(); ++r) {
    if (sights_[r].empty()) continue;
    const std::vector<ItemPlace> places = direction.to.places(r);
    if (places.empty()) {
      look(direction, r, caster, list);
      continue;
    }
    const DrawList& world = now_world_.place(places, caster.threads());
    look(direction, r, now_world_.caster(), world);
  }
}

// A point lies on the surface of its item to within its error. Along a slanted ray that is farther.
void PixelFlow::look(Direction& direction, std::size_t rows, RayCaster& caster, const DrawList& world) {
  const std::vector<Sight>& sights = sights_[rows];
  sight_directions_.clear();
  sight_behind_m_.clear();
  for (const Sight& sight : sights) {
    sight_directions_.push_back(sight.direction);
    sight_behind_m_.push_back(sight.behind_m);
  }
  met_.resize(sights.size());
  sight_rays_.cast(caster, world, direction.to.rows[rows].world_from_view, sight_directions_, sight_behind_m_, met_);
  std::vector<std::uint8_t>& occlusion = direction.occlusion->edit();
  for (std::size_t i = 0; i < sights.size(); ++i) {
    const Sight& sight = sights[i];
    const SeenSurface& met = met_[i];
    bool is_seen = met.item == sight.item;
    if (is_seen && met.item != kNoItem) {
      const double cosine = std::abs(glm::dot(met.normal, sight.direction));
      is_seen = std::abs(met.range_m - sight.range_m) <= met.error_bound_m + sight.error_bound_m / cosine;
    }
    occlusion[sight.pixel] = is_seen ? kSeen : kNotSeen;
  }
}

void PixelFlow::add_to(Measurement& measurement, const std::string& prefix, const std::string& view) const {
  const MeasuredNumbers numbers[] = {flow_backward_, flow_forward_, scene_flow_, occlusion_backward_,
                                     occlusion_forward_};
  for (std::size_t i = 0; i < std::size(kFlowOutputs); ++i) {
    const FlowOutput& output = kFlowOutputs[i];
    if (!is_wanted(output, desc_)) continue;
    const bool measured = std::visit([](const auto& all) { return !all.empty(); }, numbers[i]);
    measurement.arrays.push_back({{.name = prefix + output.name,
                                   .kind = OutputKind::image,
                                   .value_type = output.type,
                                   .shape = measured ? OutputShape{layout_.height_px, layout_.width_px, output.channels}
                                                     : OutputShape{0, 0, output.channels},
                                   .unit = output.unit,
                                   .view = view},
                                  numbers[i]});
  }
}

}  // namespace simvis
