#include "elements/visualization/laser_beams.h"

#include <simvis/pose.h>
#include "elements/visualization/scan_hits.h"

namespace simvis {
namespace {

const AttributeRows<LaserBeamsLook> kLaserBeamsRows{
    AttributeSpec{.name = "scanner",
                  .kind = AttributeKind::sensor,
                  .text = "required: name of the laser scanner; it may stand later in the scene"},
    row(&LaserBeamsLook::width_m, "width", "m", kMarkerSize_m, "thickness of a beam; 0: not drawn").live(),
    row(&LaserBeamsLook::size_m, "size", "m", kMarkerSize_m, "size of the points where beams hit; 0: not drawn").live(),
    row(&LaserBeamsLook::every, "every", "", {.min = 1, .max = 1e6},
        "N: every N-th beam of a ring is drawn, with its hit; rounded down")
        .live(),
    row(&LaserBeamsLook::miss_length_m, "miss_length", "m", {.min = 0, .max = kMaxCoordinate_m},
        "length of beams that hit nothing; 0: not drawn")
        .live(),
    row(&LaserBeamsLook::opacity, "opacity", "", {.min = 0, .max = 1}, "opacity of the beams; the hits are opaque")
        .live(),
    color_rows(&LaserBeamsLook::color, "", kMarkerColor, " of beams and hits")};

const ElementRegistration kLaserBeamsRegistration({
    .name = "laser_beams",
    .summary = "Draws the beams of a laser scanner and the points that they hit.",
    .notes = "Only cameras with view=\"visualization\" show it; simulated sensors never see it.\nThe beams start where "
             "the scanner stood when it measured. The insertion point does not matter.",
    .attributes = kLaserBeamsRows.table(),
    .create = create_element<LaserBeamsElement>,
});

}  // namespace

LaserBeamsElement::LaserBeamsElement(const ElementContext& context)
    : name_(context.command.require("name").value),
      scanner_(context.command.require("scanner").value),
      nodes_(make_marker_nodes(name_)) {
  context.scene.insert_in_world(context.command, nodes_.separator);
}

void LaserBeamsElement::update(ParameterView values) {
  kLaserBeamsRows.set(look_, values);
  nodes_.material->set_material(marker_material(look_.opacity < 1 ? AlphaMode::blend : AlphaMode::opaque));
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

// The beams are drawn again from the scan that is observed next. Without one there are none.
void LaserBeamsElement::archive(StateArchive& state) {
  if (!state.is_reading()) return;
  nodes_.shape->set_mesh(MarkerMesh().take(name_));
  stale_ = true;
}

void LaserBeamsElement::draw(const Scan& scan) {
  MarkerMesh markers;
  const auto every = static_cast<std::size_t>(look_.every);
  for_each_beam(scan, every, [&](const glm::dvec3& origin_m, const glm::dvec3& direction, double range_m) {
    const double length_m = is_hit(range_m) ? range_m : range_m > 0 ? look_.miss_length_m : 0;
    markers.add_line(origin_m, origin_m + length_m * direction, look_.width_m, glm::vec4(look_.color, look_.opacity));
  });
  for_each_beam(scan, every, [&](const glm::dvec3& origin_m, const glm::dvec3& direction, double range_m) {
    if (is_hit(range_m)) markers.add_point(origin_m + range_m * direction, look_.size_m, glm::vec4(look_.color, 1));
  });
  nodes_.shape->set_mesh(markers.take(name_));
}

}  // namespace simvis
