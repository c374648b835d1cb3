#include "sensors/proximity/radar.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <tuple>
#include <utility>

#include "effects/reported_range.h"
#include "engine/base/words.h"

namespace simvis {

namespace {

constexpr double kLightSpeed_mps = 299792458, kBoltzmann_j_k = 1.380649e-23, kNoiseTemperature_k = 290;

const std::vector<TableColumn> kRadarColumns{
    {.name = "range_m", .format = "%.12g", .unit = "m", .meaning = "distance of the detection"},
    {.name = "azimuth_rad",
     .format = "%.12g",
     .unit = "rad",
     .meaning = "direction, counter-clockwise from +x about +z",
     .frame = "sensor"},
    {.name = "elevation_rad",
     .format = "%.12g",
     .unit = "rad",
     .meaning = "direction, positive upwards",
     .frame = "sensor"},
    {.name = "radial_speed_m_s", .format = "%.12g", .unit = "m/s", .meaning = "speed along the ray; above 0: away"},
    {.name = "snr_db", .format = "%.9g", .unit = "dB", .meaning = "ratio of signal to noise"},
    {.name = "cross_section_m2", .format = "%.9g", .unit = "m2", .meaning = "radar cross section"},
    {.name = "x_m", .format = "%.12g", .unit = "m", .meaning = "place of the detection, x", .frame = "sensor"},
    {.name = "y_m", .format = "%.12g", .unit = "m", .meaning = "place of the detection, y", .frame = "sensor"},
    {.name = "z_m", .format = "%.12g", .unit = "m", .meaning = "place of the detection, z", .frame = "sensor"}};

const SensorRegistration kRadarRegistration(
    {.name = "radar",
     .summary = "A radar: detections with range, direction and radial speed, by the radar equation.",
     .notes = "Surfaces return by their projected areas, parts of known cross section by it. The radial speed follows "
              "from the true motion of what is met and of the sensor; above 0 it moves away.",
     .capabilities = kSeesSplats | kRaysHitSplats,
     .message = "sensor_msgs/msg/PointCloud2",
     .attributes = rows_of<RadarDesc>().table(),
     .create = create_sensor<Radar, RadarDesc>,
     .outputs = column_outputs_of<kRadarColumns, false>});

double from_db(double db) { return std::pow(10, db / 10); }

void read_cross_sections(RadarDesc& desc, const AttributeValues& attributes) {
  if (!attributes.is_set("cross_sections")) return;
  for (const std::string_view word : words_of(attributes.text("cross_sections"))) {
    const std::size_t colon = word.rfind(':');
    RadarDesc::CrossSection each{.part = std::string(word.substr(0, colon))};
    const bool is_pair = colon != word.npos && colon > 0 && parse_number(word.substr(colon + 1), each.square_m);
    if (!is_pair || !(each.square_m > 0)) {
      fail_at(attributes.where("cross_sections"), "attribute \"cross_sections\": " + in_quotes(word) +
                                                      " is not allowed, expected NAME:SQUARE_METRES with a number "
                                                      "above 0");
    }
    desc.cross_sections.push_back(std::move(each));
  }
}

/// Where the cells of one measure begin, so that a value of 0 lies in the middle of a cell.
std::int64_t cell_of(double value, double size) { return std::llround(value / size); }

/// Rays side by side in a field of view.
double ray_count(double fov_rad, const RadarDesc& desc) { return std::ceil(fov_rad / desc.angle_step_rad); }

constexpr double kTurn_rad = 2 * std::numbers::pi;

// The cells in azimuth. If the field of view reaches around to its other end, an even number of cells of one size fills
// the turn: the size is the nearest such share of it, and one cell has its middle behind the radar, at +-pi.
struct AzimuthCells {
  double size_rad = 0;
  std::int64_t per_turn = 0;  // 0: the field of view has two ends

  explicit AzimuthCells(const RadarDesc& desc) : size_rad(desc.azimuth_resolution_rad) {
    if (desc.horizontal_fov_rad + size_rad <= kTurn_rad) return;
    per_turn = 2 * std::max(std::llround(kTurn_rad / 2 / size_rad), 1LL);
    size_rad = kTurn_rad / static_cast<double>(per_turn);
  }
  std::int64_t of(double azimuth_rad) const {
    const std::int64_t cell = cell_of(azimuth_rad, size_rad);
    return per_turn > 0 && 2 * cell >= per_turn ? cell - per_turn : cell;
  }
  /// The same direction, as an azimuth within half a turn of the middle of its cell.
  double beside_middle(std::int64_t cell, double azimuth_rad) const {
    return azimuth_rad - kTurn_rad * std::round((azimuth_rad - static_cast<double>(cell) * size_rad) / kTurn_rad);
  }
};

struct RadarCell {
  double power_w = 0, square_m = 0;
  double range_m = 0, azimuth_rad = 0, elevation_rad = 0, speed_mps = 0;  // sums by power
};

}  // namespace

double RadarDesc::received_w(double square_m, double range_m) const {
  const double wave_m = kLightSpeed_mps / frequency_hz, gain = from_db(gain_db);
  return power_w * gain * gain * wave_m * wave_m * square_m /
         (std::pow(4 * std::numbers::pi, 3) * std::pow(range_m, 4) * from_db(losses_db));
}

double RadarDesc::noise_w() const {
  return kBoltzmann_j_k * kNoiseTemperature_k * bandwidth_hz * from_db(noise_figure_db);
}

AttributeRows<RadarDesc> RadarDesc::rows() {
  using Desc = RadarDesc;
  constexpr AttributeLimits kDecibels{.min = -300, .max = 300};
  const auto up_to = [](double max) { return AttributeLimits{.min = 0, .max = max, .open_min = true}; };
  return {
      row(&Desc::frequency_hz, "frequency", "Hz", kAboveZero, "frequency of the carrier"),
      row(&Desc::power_w, "power", "W", kAboveZero, "transmitted power"),
      row(&Desc::gain_db, "gain", "dB", kDecibels, "gain of the antenna"),
      row(&Desc::losses_db, "losses", "dB", kDecibels, "losses on the way of the signal"),
      row(&Desc::noise_figure_db, "noise_figure", "dB", kDecibels, "noise figure of the receiver"),
      row(&Desc::bandwidth_hz, "bandwidth", "Hz", kAboveZero, "bandwidth of the noise after all integration"),
      row(&Desc::threshold_db, "threshold", "dB", kDecibels, "ratio of signal to noise of a detection"),
      row(&Desc::horizontal_fov_rad, "horizontal_fov", kDegrees, up_to(360),
          "full horizontal angle of the field of view"),
      row(&Desc::vertical_fov_rad, "vertical_fov", kDegrees, up_to(180), "full vertical angle of the field of view"),
      row(&Desc::angle_step_rad, "angle_step", kDegrees, up_to(45), "largest angle between neighbouring rays"),
      row(&Desc::range_resolution_m, "range_resolution", "m", kAboveZero, "size of a cell along the range"),
      row(&Desc::azimuth_resolution_rad, "azimuth_resolution", kDegrees, kAboveZero, "size of a cell in azimuth"),
      row(&Desc::speed_resolution_mps, "speed_resolution", "m/s", kAboveZero, "size of a cell in radial speed"),
      row(&Desc::reflectivity, "reflectivity", "", kAboveZero,
          "cross section of a surface, as a share of its projected area"),
      AttributeRow<Desc>{.spec = {.name = "cross_sections",
                                  .kind = AttributeKind::text,
                                  .unit = "m2",
                                  .text = "cross sections of parts, as NAME:SQUARE_METRES; default: by their areas"},
                         .read = read_cross_sections},
      nested(&Desc::limits, range_limit_rows()),
      nested(&Desc::range, noise_rows("range_", "the range", "m")),
      nested(&Desc::azimuth, noise_rows("azimuth_", "the azimuth", "rad")),
      nested(&Desc::speed, noise_rows("speed_", "the radial speed", "m/s")),
      kRateAttribute};
}

void RadarDesc::complete(const SensorContext& context) {
  constexpr double kMaxRays = 1e7;
  if (ray_count(horizontal_fov_rad, *this) * ray_count(vertical_fov_rad, *this) <= kMaxRays) return;
  const AttributeValues& a = context.attributes;
  fail_at(a.where("angle_step"), "attribute \"angle_step\": " + format_number(a.number("angle_step")) +
                                     " makes more than 10000000 rays, expected a larger angle");
}

Radar::Radar(std::string name, const RadarDesc& desc)
    : ReadingSensor(kRadarColumns, false),
      name_(std::move(name)),
      desc_(desc),
      range_(desc.range, {desc.seed, name_ + "/range"}),
      azimuth_(desc.azimuth, {desc.seed, name_ + "/azimuth"}),
      speed_(desc.speed, {desc.seed, name_ + "/speed"}) {
  const auto columns = static_cast<int>(ray_count(desc.horizontal_fov_rad, desc)),
             rows = static_cast<int>(ray_count(desc.vertical_fov_rad, desc));
  const double width_rad = desc.horizontal_fov_rad / columns, height_rad = desc.vertical_fov_rad / rows;
  for (int row = 0; row < rows; ++row) {
    const double elevation_rad = (row + 0.5) * height_rad - desc.vertical_fov_rad / 2;
    for (int column = 0; column < columns; ++column) {
      const double azimuth_rad = (column + 0.5) * width_rad - desc.horizontal_fov_rad / 2;
      rays_.push_back({azimuth_rad, elevation_rad, width_rad * height_rad * std::cos(elevation_rad)});
      directions_.push_back(glm::normalize(beam_direction(azimuth_rad, elevation_rad)));
    }
  }
  hits_.resize(rays_.size());
}

SensorNeeds Radar::needs() const {
  SensorNeeds needs{.motion = true, .item_motion = true};
  for (const RadarDesc::CrossSection& each : desc_.cross_sections) needs.parts.push_back(each.part);
  return needs;
}

void Radar::sense(const SensedWorld& world) { world_ = &world; }

void Radar::plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) {
  ReadingSensor::plan(world_from_sensor, list, plan);
  plan.casts.push_back({.name = name_, .reason = "field of view of radar " + name_, .max_rays = rays_.size()});
}

std::vector<Radar::Echo> Radar::echoes(RayCaster& rays) {
  rays.cast(world_from_sensor(), directions_, hits_);
  const glm::dvec3 own_mps = world_->motion().velocity_mps;
  std::vector<Echo> echoes;
  for (std::size_t i = 0; i < hits_.size(); ++i) {
    const double range_m = hits_[i].range_m;
    if (!(range_m >= desc_.limits.min_m && range_m <= desc_.limits.max_m) || range_m == 0) continue;
    const glm::dvec3 way = glm::dmat3(world_from_sensor()) * directions_[i],
                     point_m = glm::dvec3(world_from_sensor()[3]) + range_m * way;
    const double speed_mps = glm::dot(way, world_->velocity_mps(hits_[i].item, point_m) - own_mps);
    echoes.push_back({.ray = i,
                      .range_m = range_m,
                      .speed_mps = speed_mps,
                      .square_m = desc_.reflectivity * range_m * range_m * rays_[i].solid_angle_sr,
                      .power_w = 0});
  }
  give_cross_sections(echoes);
  for (Echo& echo : echoes) echo.power_w = desc_.received_w(echo.square_m, echo.range_m);
  return echoes;
}

void Radar::give_cross_sections(std::vector<Echo>& echoes) const {
  for (const RadarDesc::CrossSection& each : desc_.cross_sections) {
    const ItemRange items = world_->items_of(each.part);
    const auto is_part = [&](const Echo& echo) {
      const std::uint32_t item = hits_[echo.ray].item;
      return item >= items.first && item < items.end;
    };
    double sum = 0;
    for (const Echo& echo : echoes) sum += is_part(echo) ? echo.square_m : 0;
    for (Echo& echo : echoes) {
      if (is_part(echo)) echo.square_m *= each.square_m / sum;
    }
  }
}

void Radar::cast(RayCaster& rays) {
  std::map<std::tuple<std::int64_t, std::int64_t, std::int64_t>, RadarCell> cells;
  const AzimuthCells azimuths(desc_);
  for (const Echo& echo : echoes(rays)) {
    const Ray& ray = rays_[echo.ray];
    const std::int64_t azimuth = azimuths.of(ray.azimuth_rad);
    RadarCell& cell = cells[{cell_of(echo.range_m, desc_.range_resolution_m), azimuth,
                             cell_of(echo.speed_mps, desc_.speed_resolution_mps)}];
    cell.power_w += echo.power_w;
    cell.square_m += echo.square_m;
    cell.range_m += echo.power_w * echo.range_m;
    cell.azimuth_rad += echo.power_w * azimuths.beside_middle(azimuth, ray.azimuth_rad);
    cell.elevation_rad += echo.power_w * ray.elevation_rad;
    cell.speed_mps += echo.power_w * echo.speed_mps;
  }
  const double period_s = sample_period_s(rate_hz, time_);
  std::vector<double> values;
  std::uint32_t row = 0;
  for (const auto& [key, cell] : cells) {
    const double snr_db = 10 * std::log10(cell.power_w / desc_.noise_w());
    if (!(snr_db >= desc_.threshold_db)) continue;
    const double range_m = reported_range_m(range_.apply_to_one(cell.range_m / cell.power_w, row, time_, period_s)),
                 azimuth_rad = std::remainder(
                     azimuth_.apply_to_one(cell.azimuth_rad / cell.power_w, row, time_, period_s), kTurn_rad),
                 elevation_rad = cell.elevation_rad / cell.power_w;
    const glm::dvec3 place_m = range_m * beam_direction(azimuth_rad, elevation_rad);
    values.insert(values.end(), {range_m, azimuth_rad, elevation_rad,
                                 speed_.apply_to_one(cell.speed_mps / cell.power_w, row, time_, period_s), snr_db,
                                 cell.square_m, place_m.x, place_m.y, place_m.z});
    ++row;
  }
  set_reading(time_, std::move(values));
}

}  // namespace simvis
