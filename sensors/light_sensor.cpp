#include "sensors/light_sensor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>

#include <simvis/pose.h>
#include "engine/draw/luminance.h"
#include "engine/light/direct_light.h"

namespace simvis {

namespace {

constexpr double kLightNear_m = 1e-3;  // a surface that touches the sensor is still seen

const std::vector<TableColumn> kLightSensorColumns{{.name = "illuminance_lx",
                                                    .format = "%.12g",
                                                    .unit = "lx",
                                                    .meaning = "illuminance on a plane across +x",
                                                    .frame = "sensor"},
                                                   {.name = "direct_lx",
                                                    .format = "%.12g",
                                                    .unit = "lx",
                                                    .meaning = "the part of lights, without noise",
                                                    .frame = "sensor",
                                                    .in_message = false},
                                                   {.name = "reflected_lx",
                                                    .format = "%.9g",
                                                    .unit = "lx",
                                                    .meaning = "the part of surfaces and the sky, without noise",
                                                    .frame = "sensor",
                                                    .in_message = false}};

const SensorRegistration kLightSensorRegistration(
    {.name = "light_sensor",
     .summary = "The illuminance at a point, in lux, by lights and by what surfaces reflect and emit.",
     .notes =
         "The sensor faces +x and weights light by the cosine of its angle. Lights that cast shadows are tested with "
         "a ray, surfaces are rendered. Where nothing is hit, the ambient radiance of the sky arrives.",
     .message = "sensor_msgs/msg/Illuminance",
     .attributes = rows_of<LightSensorDesc>().table(),
     .create = create_sensor<LightSensor, LightSensorDesc>,
     .outputs = column_outputs_of<kLightSensorColumns>});

/// The axis along which side `side` of the cube looks: forward first.
glm::dmat4 sensor_from_side(std::uint32_t side) {
  constexpr double kYaw_deg[] = {0, 90, -90, 0, 0}, kPitch_deg[] = {0, 0, 0, 90, -90};
  return matrix_from_degrees({0, 0, 0}, 0, kPitch_deg[side], kYaw_deg[side]);
}

/// Cosine to the sensor's axis times solid angle, for each pixel of a side.
std::vector<double> side_weights(std::uint32_t side, std::uint32_t resolution_px) {
  const glm::dmat3 sensor_from_view_of_side(sensor_from_side(side) * sensor_from_view());
  std::vector<double> weights;
  for (std::uint32_t row = 0; row < resolution_px; ++row) {
    for (std::uint32_t column = 0; column < resolution_px; ++column) {
      const double u = 2 * (column + 0.5) / resolution_px - 1, v = 2 * (row + 0.5) / resolution_px - 1;
      const glm::dvec3 ray(u, v, 1);
      const double length = glm::length(ray), pixel = 2.0 / resolution_px;
      const double cosine = (sensor_from_view_of_side * ray).x / length;
      weights.push_back(std::max(0.0, cosine) * pixel * pixel / (length * length * length));
    }
  }
  return weights;
}

}  // namespace

AttributeRows<LightSensorDesc> LightSensorDesc::rows() {
  return {row(&LightSensorDesc::resolution_px, "resolution", "px", {.min = 2, .max = 1024},
              "pixels along a side of the cube that is rendered"),
          nested(&LightSensorDesc::noise, noise_rows("", "the illuminance", "lx")), kRateAttribute};
}

LightSensor::LightSensor(std::string name, const LightSensorDesc& desc)
    : ReadingSensor(kLightSensorColumns),
      name_(std::move(name)),
      desc_(desc),
      noise_(desc.noise, {desc.seed, name_ + "/illuminance"}) {
  double sum = 0;
  for (std::uint32_t side = 0; side < kSides; ++side) {
    weights_[side] = side_weights(side, desc.resolution_px);
    for (const double weight : weights_[side]) sum += weight;
  }
  for (std::vector<double>& side : weights_) {
    for (double& weight : side) weight *= std::numbers::pi / sum;
  }
}

void LightSensor::plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) {
  ReadingSensor::plan(world_from_sensor, list, plan);
  list_ = &list;
  const std::uint32_t size = desc_.resolution_px;
  pass_ = plan.passes.size();
  plan.passes.push_back(
      {.name = name_, .width_px = size * kSides, .height_px = size, .color = true, .depth = true, .views = {}});
  for (std::uint32_t side = 0; side < kSides; ++side) {
    View view;
    view.name = name_ + "/side " + std::to_string(side);
    view.reason = "hemisphere of light sensor " + name_;
    view.pinhole = centred_pinhole(size, size, std::numbers::pi / 2);
    view.near_m = kLightNear_m;
    view.view_from_world = rigid_inverse(world_from_sensor * sensor_from_side(side) * sensor_from_view());
    view.x_px = side * size;
    view.width_px = view.height_px = size;
    view.sees_lines_and_points = false;
    plan.passes.back().views.push_back(std::move(view));
  }
  plan.casts.push_back({.name = name_, .reason = "lights of light sensor " + name_, .max_rays = list.lights.size()});
}

void LightSensor::collect(const FrameTime& time, const FramePlan&, std::span<const PassResult> results) {
  time_ = time;
  const PassResult& seen = results[pass_];
  const std::size_t size = desc_.resolution_px, width = size * kSides;
  const glm::dvec3 sky(list_->environment.ambient);
  reflected_lx_ = 0;
  for (std::uint32_t side = 0; side < kSides; ++side) {
    for (std::size_t pixel = 0; pixel < size * size; ++pixel) {
      const double weight = weights_[side][pixel];
      if (weight == 0) continue;
      const std::size_t at = pixel / size * width + side * size + pixel % size;
      const bool hit = seen.depth[at] > 0;
      reflected_lx_ += weight * luminance(hit ? glm::dvec3(seen.color[at]) : sky);
    }
  }
}

double LightSensor::direct_lx(RayCaster& rays) const {
  const glm::dmat4& pose = world_from_sensor();
  const glm::dmat3 sensor_from_world = glm::transpose(glm::dmat3(pose));
  double sum = 0;
  for (const LightItem& item : list_->lights) {
    const DirectLight direct = direct_light(item.light, list_->world_from_node[item.transform], glm::dvec3(pose[3]));
    const double illuminance_lx =
        luminance(direct.irradiance) * std::max(0.0, glm::dot(glm::dvec3(pose[0]), direct.toward));
    if (illuminance_lx == 0) continue;
    if (item.light.shadow_px > 0) {
      const glm::dvec3 toward = glm::normalize(sensor_from_world * direct.toward);
      RayHit hit;
      rays.cast(pose, {&toward, 1}, {&hit, 1});
      if (hit.range_m < direct.distance_m) continue;
    }
    sum += illuminance_lx;
  }
  return sum;
}

void LightSensor::cast(RayCaster& rays) {
  const double direct = direct_lx(rays), period_s = sample_period_s(rate_hz, time_);
  set_constant("illuminance_variance", desc_.noise.white_variance(period_s));
  set_reading(time_, {noise_.apply(direct + reflected_lx_, 0, time_, period_s), direct, reflected_lx_});
}

}  // namespace simvis
