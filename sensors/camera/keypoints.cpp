#include "sensors/camera/keypoints.h"

#include <algorithm>
#include <limits>
#include <span>
#include <utility>

#include <simvis/pose.h>
#include "effects/camera/rolling_shutter.h"
#include "sensors/camera/pinhole_view.h"

namespace simvis {
namespace {

// In the report, the name of a point is a note "point NUMBER".
const std::string kNote = "point ";

constexpr double kNoPlace = std::numeric_limits<double>::quiet_NaN();

std::vector<TableColumn> keypoint_columns() {
  const auto number = [](const char* name, const char* unit, const char* meaning, const char* frame = "") {
    return TableColumn{
        .name = name, .format = std::string(kExactFormat), .unit = unit, .meaning = meaning, .frame = frame};
  };
  const auto whole = [](const char* name, const char* meaning) {
    return TableColumn{.name = name, .format = "%lld", .integer = true, .meaning = meaning};
  };
  std::vector<TableColumn> columns{whole("point", "number of the point; run.json has its name"),
                                   number("x_px", "px", "its place in the picture, from the left edge"),
                                   number("y_px", "px", "its place in the picture, from the upper edge"),
                                   whole("in_picture", "1: the place is within the picture"),
                                   whole("visible", "1: it is in the picture, and no surface hides it"),
                                   number("distance_m", "m", "from the camera"),
                                   number("x_m", "m", "the point", "sensor"),
                                   number("y_m", "m", "the point", "sensor"),
                                   number("z_m", "m", "the point", "sensor")};
  columns[1].nothing = columns[2].nothing = kNoPlace;
  return columns;
}

constexpr std::uint8_t kKeypointsCapabilities = kHasLens | kHasPixelRays;

const SensorRegistration kKeypointsRegistration(
    {.name = "keypoints",
     .summary = "Where named points of the scene are in the picture of a camera, and whether it sees them.",
     .notes = "Keypoints are the insertion points whose names match. A table has a row for each. The sensor "
              "stands where the camera stands, and has its width, height, hfov, near, lens and shutter. docs/truth.md "
              "has an example.",
     .capabilities = kKeypointsCapabilities,
     .message = "sensor_msgs/msg/PointCloud2",
     .attributes = rows_of<KeypointsDesc>().table(),
     .create = create_sensor<Keypoints, KeypointsDesc>,
     .outputs = [](const SensorContext& context) { return reading_outputs(context, keypoint_columns(), false); }});

}  // namespace

std::map<std::uint32_t, std::string> keypoint_names(const SensorReport& report) {
  std::map<std::uint32_t, std::string> names;
  for (const SensorNote& note : report.notes) {
    if (!note.name.starts_with(kNote)) continue;
    names[static_cast<std::uint32_t>(std::stoul(note.name.substr(kNote.size())))] = std::get<std::string>(note.value);
  }
  return names;
}

AttributeRows<KeypointsDesc> KeypointsDesc::rows() {
  using Desc = KeypointsDesc;
  return {row(&Desc::points, AttributeKind::objects, "points",
              "names and patterns of the insertion points; * stands for any text, ? for any character"),
          nested(&Desc::pinhole, PinholeDesc::rows()),
          row(&Desc::radius_m, "radius", "m", kNotNegative,
              "surfaces that are at most so much nearer than a point belong to it and hide nothing"),
          kRateAttribute};
}

void KeypointsDesc::complete(const SensorContext& context) {
  effects = camera_effects(kKeypointsCapabilities,
                           {context.attributes, context.seed, context.name, shown_outputs(false, true)});
}

Keypoints::Keypoints(std::string name, const KeypointsDesc& desc)
    : ReadingSensor(keypoint_columns(), false),
      name_(std::move(name)),
      desc_(desc),
      layout_(camera_layout(desc.pinhole, desc.effects)),
      views_(camera_views(layout_, 1)),
      calibrations_(std::make_shared<const std::vector<Calibration>>(
          std::vector{Calibration{.view = "", .camera = calibration_of(layout_)}})) {
  if (layout_.rays.empty() || layout_.pixel_of != nullptr) return;
  throw InputError("sensor " + in_quotes(name_) +
                   ": an effect does not say where its lens shows a direction, expected another effect");
}

void Keypoints::begin(const FrameTime& time) {
  time_ = time;
  if (last_ns_ && *last_ns_ < time.time_ns) before_ns_ = last_ns_;
}

void Keypoints::sense(const SensedWorld& world) {
  points_ = world.points();
  if (is_late()) {
    moves_ = world.item_moves();
    path_ = &world.sensor_path();
  }
}

void Keypoints::skip_frame(const FrameTime& time, const glm::dmat4&) {
  begin(time);
  last_ns_ = time.time_ns;
}

void Keypoints::plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) {
  ReadingSensor::plan(world_from_sensor, list, plan);
  list_ = &list;
  if (!points_.empty()) {
    plan.casts.push_back({.name = name_, .reason = "lines of sight of keypoints " + name_, .max_rays = points_.size()});
  }
  plan_effects(name_, desc_.effects, plan);
}

// Views of the same rows share their pose.
CameraMoment Keypoints::moment() const {
  CameraMoment moment{.time_ns = time_.time_ns, .scene = nullptr, .rows = {}};
  const double between_s = before_ns_ ? static_cast<double>(time_.time_ns - *before_ns_) / 1e9 : 0;
  std::uint32_t next_row = 0;
  for (const CameraView& view : views_.views) {
    if (view.first_row < next_row) continue;
    next_row = view.first_row + view.rows;
    const double share = before_ns_ ? view.time_s / between_s : 0;
    const glm::dmat4 world_from_camera =
        share == 0 ? world_from_sensor() : place_at(*path_, share, world_from_sensor());
    moment.rows.push_back({.first = view.first_row,
                           .count = view.rows,
                           .world_from_view = world_from_camera * sensor_from_view(),
                           .share = share});
  }
  return moment;
}

Keypoints::Row Keypoints::find(const SensedPoint& point, const CameraMoment& moment, std::size_t& rows) const {
  Row row;
  RowSearch search(moment, moment.rows.size() - 1);
  do {
    rows = search.rows();
    const PosedRows& posed = moment.rows[rows];
    const glm::dmat4 place = point.path != nullptr && posed.share != 0
                                 ? place_at(*point.path, posed.share, point.world_from_point)
                                 : point.world_from_point;
    row.place_m = glm::dvec3(rigid_inverse(posed.world_from_view) * place[3]);
    row.pixel = row.place_m == glm::dvec3(0) ? std::nullopt : layout_.pixel(row.place_m);
    if (!row.pixel) return row;
  } while (search.next(row.pixel->y));
  row.in_picture = search.is_met() && row.pixel->x >= 0 && row.pixel->y >= 0 && row.pixel->x < layout_.width_px &&
                   row.pixel->y < layout_.height_px;
  return row;
}

// Empty: nothing is seen there, or only what is farther than the point.
std::optional<Keypoints::Sight> Keypoints::sight_of(const Row& row) const {
  if (!row.in_picture) return std::nullopt;
  Sight sight{.range_m = glm::length(row.place_m)};
  sight.direction = row.place_m / sight.range_m;
  double along = sight.direction.z;  // of the axis that `near` is measured along
  if (!views_.taps.empty()) {
    const auto x = static_cast<std::size_t>(row.pixel->x), y = static_cast<std::size_t>(row.pixel->y);
    const PixelTap& tap = views_.taps[y * layout_.width_px + x];
    if (tap.view == PixelTap::kNone) return std::nullopt;
    along = (views_.views[tap.view].face_from_view * sight.direction).z;
  }
  if (along <= 0) return std::nullopt;
  sight.near_range_m = desc_.pinhole.near_m / along;
  if (sight.range_m < sight.near_range_m) return std::nullopt;
  return sight;
}

void Keypoints::look(RayCaster& caster, const CameraMoment& moment, std::vector<Sight>& sights,
                     std::vector<Row>& table) {
  std::ranges::stable_sort(sights, {}, &Sight::rows);
  moved_.set(*list_);
  for (std::size_t first = 0; first < sights.size();) {
    const PosedRows& posed = moment.rows[sights[first].rows];
    std::vector<glm::dvec3> directions;
    std::vector<double> near_range_m;
    std::size_t end = first;
    for (; end < sights.size() && sights[end].rows == sights[first].rows; ++end) {
      directions.push_back(sights[end].direction);
      near_range_m.push_back(sights[end].near_range_m);
    }
    std::vector<ItemPlace> places;
    for (const ItemMove& move : posed.share == 0 ? std::span<const ItemMove>() : moves_) {
      const glm::dmat4& now = list_->world_from_node[list_->items[move.item].transform];
      places.push_back({move.item, place_at(*move.path, posed.share, now)});
    }
    const DrawList& world = places.empty() ? *list_ : moved_.place(places, caster.threads());
    std::vector<SeenSurface> seen(directions.size());
    rays_.cast(places.empty() ? caster : moved_.caster(), world, posed.world_from_view, directions, near_range_m, seen);
    for (std::size_t i = first; i < end; ++i) {
      const SeenSurface& surface = seen[i - first];
      const double bound_m = surface.item == kNoItem ? 0 : surface.error_bound_m;
      table[sights[i].point].visible = surface.range_m + bound_m >= sights[i].range_m - desc_.radius_m;
    }
    first = end;
  }
}

void Keypoints::cast(RayCaster& caster) {
  const CameraMoment moment = this->moment();
  std::vector<Row> table;
  std::vector<Sight> sights;
  for (const SensedPoint& point : points_) {
    std::size_t rows = 0;
    table.push_back(find(point, moment, rows));
    std::optional<Sight> sight = sight_of(table.back());
    if (!sight) continue;
    sight->point = table.size() - 1;
    sight->rows = rows;
    sights.push_back(*sight);
  }
  look(caster, moment, sights, table);
  std::vector<double> values;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const Row& row = table[i];
    const glm::dvec3 place_m(sensor_from_view() * glm::dvec4(row.place_m, 1));
    values.insert(values.end(), {static_cast<double>(points_[i].number), row.pixel ? row.pixel->x : kNoPlace,
                                 row.pixel ? row.pixel->y : kNoPlace, row.in_picture ? 1.0 : 0.0,
                                 row.visible ? 1.0 : 0.0, glm::length(row.place_m), place_m.x, place_m.y, place_m.z});
  }
  set_reading(time_, std::move(values));
  last_ns_ = time_.time_ns;
}

Measurement Keypoints::measurement() const {
  Measurement measurement = ReadingSensor::measurement();
  measurement.calibrations = calibrations_;
  return measurement;
}

SensorReport Keypoints::report() const {
  SensorReport report;
  for (const SensedPoint& point : points_) {
    report.notes.push_back({kNote + std::to_string(point.number), point.name});
  }
  return report;
}

}  // namespace simvis
