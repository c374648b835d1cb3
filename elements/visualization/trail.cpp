#include "elements/visualization/trail.h"

#include <cmath>

namespace simvis {
namespace {

constexpr AttributeSpec kTrailAttributes[] = {
    {.name = "part", .kind = AttributeKind::part, .text = "required: name of the part"},
    marker_size_row("width", "0.03", "thickness of the line; 0: not drawn"),
    {.name = "step",
     .kind = AttributeKind::number,
     .default_value = "0.05",
     .unit = "m",
     .text = "distance from the last point at which the next point is added",
     .min = 0.001,
     .max = kMaxMarker_m,
     .live = true},
    {.name = "keep",
     .kind = AttributeKind::number,
     .default_value = "2000",
     .text = "number of newest points that are kept; rounded down",
     .min = 2,
     .max = 100000,
     .live = true},
    color_row("red", "0.05", "red of the line"),
    color_row("green", "0.2", "green of the line"),
    color_row("blue", "0.9", "blue of the line"),
};

const ElementRegistration kTrailRegistration({
    .name = "trail",
    .summary = "Draws the path that a part has travelled.",
    .notes = "Only cameras with view=\"visualization\" show it; simulated sensors never see it.\nThe path takes in "
             "every movement of the part. The insertion point does not matter.",
    .attributes = kTrailAttributes,
    .create = [](const ElementContext& context) -> std::unique_ptr<Element> {
      return std::make_unique<TrailElement>(context);
    },
});

}  // namespace

TrailElement::TrailElement(const ElementContext& context)
    : name_(context.command.require("name").value),
      nodes_(make_marker_nodes(name_)),
      mount_(std::make_shared<Mount>()) {
  const std::string& part = context.command.require("part").value;
  context.scene.insert_in_world(context.command, nodes_.separator);
  const auto behind_point = std::make_shared<VisualSeparator>();
  behind_point->name = mount_->name = name_;
  behind_point->add(mount_);
  context.scene.insert_behind_point(part, behind_point);
}

void TrailElement::update(ParameterView values) {
  width_m_ = values[0];
  step_m_ = values[1];
  keep_ = static_cast<std::size_t>(values[2]);
  color_ = {values[3], values[4], values[5], 1};
  stale_ = true;
}

void TrailElement::observe(const Observations& seen) {
  const bool moved = add_point(seen);
  if (!moved && !stale_) return;
  while (path_.size() > keep_) path_.pop_front();
  draw();
  stale_ = false;
}

// Returns false if the part has moved less than one step or is switched off.
bool TrailElement::add_point(const Observations& seen) {
  glm::dmat4 world_from_part;
  if (!seen.find_mount(*mount_, world_from_part)) return false;
  const glm::dvec3 place = world_from_part[3];
  if (!std::isfinite(place.x + place.y + place.z)) return false;
  if (!path_.empty() && glm::distance(place, path_.back()) < step_m_) return false;
  path_.push_back(place);
  return true;
}

void TrailElement::draw() {
  MarkerMesh markers;
  if (!path_.empty()) {
    // People look at the present position of the part, so the float32 mesh has its origin and best resolution there.
    const glm::dvec3 origin = path_.back();
    for (std::size_t i = 1; i < path_.size(); ++i) {
      markers.add_line(path_[i - 1] - origin, path_[i] - origin, width_m_, color_);
    }
    glm::dmat4 world_from_mesh{1.0};
    world_from_mesh[3] = {origin, 1};
    nodes_.place->set_matrix(world_from_mesh);
  }
  nodes_.shape->set_mesh(markers.take(name_));
}

}  // namespace simvis
