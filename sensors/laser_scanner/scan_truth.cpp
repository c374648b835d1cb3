#include "sensors/laser_scanner/scan_truth.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <utility>

#include <simvis/surface_point.h>

namespace simvis {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

// A column of truth, and the word of the attribute that asks for it.
struct TruthColumn {
  const char* word;
  bool ScanTruthDesc::*wanted;
  TableColumn column;
};

const std::vector<TruthColumn>& all_columns() {
  const auto number = [](const char* name, const char* meaning) {
    return TableColumn{.name = name, .format = "%.0f", .meaning = meaning, .nothing = kNothing};
  };
  const auto axis = [](const char* name, const char* unit, const char* meaning, const char* frame) {
    return TableColumn{
        .name = name, .format = "%.9g", .unit = unit, .meaning = meaning, .frame = frame, .nothing = kNothing};
  };
  static const std::vector<TruthColumn> columns{
      {"range",
       &ScanTruthDesc::range,
       {.name = kTrueRange,
        .format = "%.17g",
        .unit = "m",
        .meaning = "exact range of the beam without effects",
        .nothing = std::numeric_limits<double>::infinity()}},
      {"hit", &ScanTruthDesc::hit, number(kTrueItem, "number of the mesh that the beam meets")},
      {"hit", &ScanTruthDesc::hit,
       number(kTruePrimitive,
              "number of the triangle of that mesh, or of the splat; of a round shape the face: 0 round, 1 bottom, 2 "
              "top")},
      {"instance", &ScanTruthDesc::instance,
       number(kTrueInstance, "id of the object that the beam meets, as in objects.csv")},
      {"semantic", &ScanTruthDesc::semantic, number(kTrueSemantic, "id of its class; 0: it has none")},
      {"normal", &ScanTruthDesc::normal, axis("true_normal_x", "", "normal of the triangle, x", "sensor")},
      {"normal", &ScanTruthDesc::normal, axis("true_normal_y", "", "normal of the triangle, y", "sensor")},
      {"normal", &ScanTruthDesc::normal, axis("true_normal_z", "", "normal of the triangle, z", "sensor")},
      {"velocity", &ScanTruthDesc::velocity, axis("true_velocity_x_mps", "m/s", "velocity of the point, x", "world")},
      {"velocity", &ScanTruthDesc::velocity, axis("true_velocity_y_mps", "m/s", "velocity of the point, y", "world")},
      {"velocity", &ScanTruthDesc::velocity, axis("true_velocity_z_mps", "m/s", "velocity of the point, z", "world")},
      {"shape", &ScanTruthDesc::shape, number(kTrueShape, "id of the shape that the beam meets, as in shapes.csv")},
      {"radial_speed",
       &ScanTruthDesc::radial_speed,
       {.name = kTrueRadialSpeed,
        .format = "%.9g",
        .unit = "m/s",
        .meaning = "speed of the point along the beam, as a FMCW lidar measures it; above 0: away",
        .nothing = kNothing}}};
  return columns;
}

// The values of all columns for one beam, in their order; those that are not asked for stay NaN.
void measure(const ScanTruthDesc& desc, const MetSurfaces& met, std::size_t i, std::span<double> values) {
  const RayHit& hit = met.hits[i];
  values[0] = hit.range_m;
  if (std::isinf(hit.range_m)) return;
  values[1] = hit.item;
  values[2] = hit.primitive;
  if (desc.needs_ids()) {
    const ItemIds ids = met.world->item_ids();
    values[3] = ids.instance[hit.item];
    values[4] = ids.semantic[hit.item];
    values[11] = ids.shape[hit.item];
  }
  const auto put = [&](std::size_t first, const glm::dvec3& v) {
    for (int c = 0; c < 3; ++c) values[first + static_cast<std::size_t>(c)] = v[c];
  };
  const glm::dvec3& direction = met.directions[i];
  const glm::dvec3 origin_m = met.origins_m.empty() ? glm::dvec3(0) : met.origins_m[i];
  const bool is_splat = met.list.meshes[met.list.items[hit.item].mesh]->splats != nullptr;
  if (desc.normal && !is_splat)
    put(5, surface_point(met.list, glm::translate(met.world_from_sensor, origin_m), direction, hit).normal);
  if (!desc.looks_back()) return;
  const glm::dvec3 point_m(met.world_from_sensor * glm::dvec4(origin_m + hit.range_m * direction, 1));
  const glm::dvec3 velocity_mps = met.world->velocity_mps(hit.item, point_m);
  if (desc.velocity) put(8, velocity_mps);
  if (desc.radial_speed) {
    const glm::dmat3 turn(met.world_from_sensor);
    const Motion motion = met.world->motion();
    const glm::dvec3 start_mps = motion.velocity_mps + glm::cross(motion.angular_velocity_radps, turn * origin_m);
    values[12] = glm::dot(turn * direction, velocity_mps - start_mps);
  }
}

}  // namespace

AttributeRows<ScanTruthDesc> ScanTruthDesc::rows() {
  return flags_row<ScanTruthDesc>("truth",
                                  {{"range", &ScanTruthDesc::range},
                                   {"hit", &ScanTruthDesc::hit},
                                   {"instance", &ScanTruthDesc::instance},
                                   {"semantic", &ScanTruthDesc::semantic},
                                   {"normal", &ScanTruthDesc::normal},
                                   {"velocity", &ScanTruthDesc::velocity},
                                   {"radial_speed", &ScanTruthDesc::radial_speed},
                                   {"shape", &ScanTruthDesc::shape}},
                                  "columns of what the beam meets without any effect, by an exact cast: range adds "
                                  "true_range_m, hit adds true_item "
                                  "and true_primitive, the others columns of their name; default: none");
}

std::vector<OutputSpec> scan_truth_outputs(const AttributeValues& attributes, const OutputShape& shape) {
  std::vector<OutputSpec> outputs;
  for (const TruthColumn& each : all_columns()) {
    OutputSpec& output =
        outputs.emplace_back(column_outputs({&each.column, 1}, OutputKind::scan_column, shape).front());
    output.message = kPointsMessage;
    output.when = std::string(each.word) + " among truth";
    output.given = attributes.is_set("truth") && attributes.flag("truth", each.word);
  }
  return outputs;
}

void add_truth(const ScanTruthDesc& desc, const MetSurfaces& met, Scan& scan) {
  const std::vector<TruthColumn>& columns = all_columns();
  std::vector<std::vector<double>> values;
  for (const TruthColumn& each : columns) values.emplace_back(desc.*each.wanted ? met.hits.size() : 0, kNothing);
  std::vector<double> of_beam(columns.size());
  for (std::size_t i = 0; i < met.hits.size(); ++i) {
    of_beam.assign(columns.size(), kNothing);
    measure(desc, met, i, of_beam);
    for (std::size_t c = 0; c < columns.size(); ++c) {
      if (desc.*columns[c].wanted) values[c][met.order[i]] = of_beam[c];
    }
  }
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (desc.*columns[c].wanted) scan.add_channel(columns[c].column, std::move(values[c]));
  }
}

}  // namespace simvis
