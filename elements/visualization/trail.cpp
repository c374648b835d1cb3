#include "elements/visualization/trail.h"

#include <cmath>

#include <simvis/pose.h>

namespace simvis {
namespace {

const AttributeRows<TrailLook> kTrailRows{
    AttributeSpec{.name = "part", .kind = AttributeKind::object, .text = "required: name of the part or link"},
    row(&TrailLook::width_m, "width", "m", kMarkerSize_m, "thickness of the line; 0: not drawn").live(),
    row(&TrailLook::step_m, "step", "m", {.min = 0.001, .max = kMaxMarker_m},
        "distance from the last point at which the next point is added")
        .live(),
    row(&TrailLook::keep, "keep", "", {.min = 2, .max = 100000}, "number of newest points that are kept; rounded down")
        .live(),
    color_rows(&TrailLook::color, "", kMarkerColor, " of the line")};

const ElementRegistration kTrailRegistration({
    .name = "trail",
    .summary = "Draws the path that a part has travelled.",
    .notes = "Only cameras with view=\"visualization\" show it; simulated sensors never see it.\nThe path takes in "
             "every movement of the part. The insertion point does not matter.",
    .attributes = kTrailRows.table(),
    .create = create_element<TrailElement>,
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
  kTrailRows.set(look_, values);
  stale_ = true;
}

void TrailElement::observe(const Observations& seen) {
  const bool moved = add_point(seen);
  if (!moved && !stale_) return;
  while (path_.size() > static_cast<std::size_t>(look_.keep)) path_.pop_front();
  draw();
  stale_ = false;
}

// Returns false if the part has moved less than one step or is switched off.
bool TrailElement::add_point(const Observations& seen) {
  glm::dmat4 world_from_part;
  if (!seen.find_mount(*mount_, world_from_part)) return false;
  const glm::dvec3 place = world_from_part[3];
  for (glm::length_t axis = 0; axis < 3; ++axis) {
    if (!(std::abs(place[axis]) <= kMaxCoordinate_m)) return false;
  }
  if (!path_.empty() && glm::distance(place, path_.back()) < look_.step_m) return false;
  path_.push_back(place);
  return true;
}

void TrailElement::archive(StateArchive& state) {
  std::size_t points = path_.size();
  state.count(points, sizeof(glm::dvec3));
  path_.resize(points);
  for (glm::dvec3& each : path_) {
    state.finite(each);
    for (glm::length_t axis = 0; axis < 3; ++axis) state.require(std::abs(each[axis]) <= kMaxCoordinate_m);
  }
  if (state.is_reading()) stale_ = true;
}

void TrailElement::draw() {
  MarkerMesh markers;
  if (!path_.empty()) {
    // People look at the present position of the part, so the float32 mesh has its origin and best resolution there.
    const glm::dvec3 origin = path_.back();
    for (std::size_t i = 1; i < path_.size(); ++i) {
      markers.add_line(path_[i - 1] - origin, path_[i] - origin, look_.width_m, glm::vec4(look_.color, 1));
    }
    glm::dmat4 world_from_mesh{1.0};
    world_from_mesh[3] = {origin, 1};
    nodes_.place->set_matrix(world_from_mesh);
  }
  nodes_.shape->set_mesh(markers.take(name_));
}

}  // namespace simvis
