#include "elements/visualization/laser_beams.h"

#include <simvis/pose.h>
#include "elements/visualization/scan_hits.h"

namespace simvis {
namespace {

constexpr AttributeSpec kLaserBeamsAttributes[] = {
    {.name = "scanner",
     .kind = AttributeKind::sensor,
     .text = "required: name of the laser scanner; it may stand later in the scene"},
    marker_size_row("width", "0.01", "thickness of a beam; 0: not drawn"),
    marker_size_row("size", "0.04", "size of the points where beams hit; 0: not drawn"),
    {.name = "every",
     .kind = AttributeKind::number,
     .default_value = "1",
     .text = "N: every N-th beam of a ring is drawn, with its hit; rounded down",
     .min = 1,
     .max = 1e6,
     .live = true},
    {.name = "miss_length",
     .kind = AttributeKind::number,
     .default_value = "0",
     .unit = "m",
     .text = "length of beams that hit nothing; 0: not drawn",
     .min = 0,
     .max = kMaxCoordinate_m,
     .live = true},
    {.name = "opacity",
     .kind = AttributeKind::number,
     .default_value = "0.3",
     .text = "opacity of the beams; the hits are opaque",
     .min = 0,
     .max = 1,
     .live = true},
    color_row("red", "1", "red of beams and hits"),
    color_row("green", "0.05", "green of beams and hits"),
    color_row("blue", "0.02", "blue of beams and hits"),
};

const ElementRegistration kLaserBeamsRegistration({
    .name = "laser_beams",
    .summary = "Draws the beams of a laser scanner and the points that they hit.",
    .notes = "Only cameras with view=\"visualization\" show it; simulated sensors never see it.\nThe beams start where "
             "the scanner stood when it measured. The insertion point does not matter.",
    .attributes = kLaserBeamsAttributes,
    .create = [](const ElementContext& context) -> std::unique_ptr<Element> {
      return std::make_unique<LaserBeamsElement>(context);
    },
});

}  // namespace

LaserBeamsElement::LaserBeamsElement(const ElementContext& context)
    : name_(context.command.require("name").value),
      scanner_(context.command.require("scanner").value),
      nodes_(make_marker_nodes(name_)) {
  context.scene.insert_in_world(context.command, nodes_.separator);
}

void LaserBeamsElement::update(ParameterView values) {
  width_m_ = values[0];
  size_m_ = values[1];
  every_ = static_cast<std::size_t>(values[2]);
  miss_length_m_ = values[3];
  color_ = {values[5], values[6], values[7], values[4]};
  nodes_.material->set_material(marker_material(color_.a < 1 ? AlphaMode::blend : AlphaMode::opaque));
  stale_ = true;
}

void LaserBeamsElement::observe(const Observations& seen) {
  const ObservedScan observed = seen.scan(scanner_);
  if (observed.scan == nullptr || (observed.count == drawn_ && !stale_)) return;
  nodes_.place->set_matrix(observed.world_from_sensor);
  draw(*observed.scan);
  drawn_ = observed.count;
  stale_ = false;
}

void LaserBeamsElement::draw(const Scan& scan) {
  MarkerMesh markers;
  for_each_beam(scan, every_, [&](const glm::dvec3& origin_m, const glm::dvec3& direction, double range_m) {
    const double length_m = is_hit(range_m) ? range_m : range_m > 0 ? miss_length_m_ : 0;
    markers.add_line(origin_m, origin_m + length_m * direction, width_m_, color_);
  });
  for_each_beam(scan, every_, [&](const glm::dvec3& origin_m, const glm::dvec3& direction, double range_m) {
    if (is_hit(range_m)) markers.add_point(origin_m + range_m * direction, size_m_, {glm::vec3(color_), 1});
  });
  nodes_.shape->set_mesh(markers.take(name_));
}

}  // namespace simvis
