#include "elements/visualization/point_cloud.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>
#include <utility>

#include <simvis/pose.h>
#include "elements/visualization/scan_hits.h"
#include "engine/base/read_error.h"

namespace simvis {
namespace {

constexpr int kMaxScans = 10000;

const AttributeRows<PointCloudLook> kPointCloudRows{
    AttributeSpec{.name = "file",
                  .kind = AttributeKind::file,
                  .text = ".csv or .xyz file with points \"x y z\" or \"x y z r g b\""},
    AttributeSpec{.name = "scanner", .kind = AttributeKind::sensor, .text = "name of a laser scanner, instead of file"},
    row(&PointCloudLook::count, "count", "", {.min = 0, .max = kMaxPoints},
        "number of points of the file or of each scan that are drawn, from the first; rounded down")
        .live(),
    row(&PointCloudLook::size_m, "size", "m", kMarkerSize_m, "size of a point; 0: not drawn").live(),
    row(&PointCloudLook::keep, "keep", "", {.min = 1, .max = kMaxScans},
        "number of the scanner's last scans that are drawn; rounded down")
        .live(),
    color_rows(&PointCloudLook::color, "", kMarkerColor, " of points that have no colour of their own")};

const ElementRegistration kPointCloudRegistration({
    .name = "point_cloud",
    .summary = "Draws points from a file, or the points that a laser scanner hit.",
    .notes = "Only cameras with view=\"visualization\" show it; simulated sensors never see it.\nA scene gives either "
             "file or scanner. Points of a file stand in the frame of the insertion point, points of a scanner in the "
             "world. A file has at most a million lines \"x y z\" or \"x y z r g b\" (metres; sRGB from 0 to 255), "
             "separated by spaces or commas.",
    .attributes = kPointCloudRows.table(),
    .create = create_element<PointCloudElement>,
});

std::filesystem::path find_point_file(const ElementContext& context) {
  const CommandAttribute& file = context.command.require("file");
  const std::filesystem::path path = context.command.folder / file.value;
  const std::string ending = path.extension().string();
  if (ending != ".csv" && ending != ".xyz") {
    fail_at(file.where,
            "point file " + in_quotes(path.string()) + " is of an unknown kind, expected one of: .csv, .xyz");
  }
  if (!is_input_file(path)) {
    fail_at(file.where, "there is no point file " + in_quotes(path.string()));
  }
  return path;
}

}  // namespace

PointCloudElement::PointCloudElement(const ElementContext& context)
    : name_(context.command.require("name").value),
      separator_(std::make_shared<VisualSeparator>()),
      batch_nodes_(std::make_shared<Group>()) {
  const Command& command = context.command;
  const CommandAttribute* const scanner = command.find("scanner");
  if ((scanner != nullptr) == (command.find("file") != nullptr)) {
    fail_at(command.where, "expected exactly one of the attributes \"file\" and \"scanner\"");
  }
  separator_->name = name_;
  separator_->add(std::make_shared<MaterialNode>(marker_material(AlphaMode::opaque)));
  separator_->add(batch_nodes_);
  if (scanner != nullptr) {
    scanner_ = scanner->value;
    context.scene.insert_in_world(command, separator_);
  } else {
    add_file(context);
    context.scene.insert(command, separator_);
  }
}

void PointCloudElement::add_file(const ElementContext& context) {
  const PointFile file = read_point_file(find_point_file(context));
  const glm::dvec3 origin = file.points.front().position_m;  // maps may lie far from the origin
  Batch& batch = add_batch();
  for (const FilePoint& point : file.points) {
    batch.points_m.emplace_back(point.position_m - origin);
    if (file.has_colors) batch.colors.push_back(point.color);
  }
  glm::dmat4 frame_from_mesh{1.0};
  frame_from_mesh[3] = {origin, 1};
  batch.place->set_matrix(frame_from_mesh);
}

PointCloudElement::Batch& PointCloudElement::add_batch() {
  Batch& batch = batches_.emplace_back(Batch{.separator = std::make_shared<Separator>(),
                                             .place = std::make_shared<Transform>(),
                                             .shape = std::make_shared<Shape>(MarkerMesh().take(name_))});
  batch.separator->add(batch.place);
  batch.separator->add(batch.shape);
  batch_nodes_->add(batch.separator);
  return batch;
}

void PointCloudElement::update(ParameterView values) {
  kPointCloudRows.set(look_, values);
  for (; batches_.size() > static_cast<std::size_t>(look_.keep); batches_.pop_front())
    batch_nodes_->remove(*batches_.front().separator);
  stale_ = true;
}

// Meshes are made here, so that a scene without visualization cameras has no cost.
void PointCloudElement::observe(const Observations& seen) {
  if (stale_) {
    for (Batch& batch : batches_) draw(batch);
    stale_ = false;
  }
  if (scanner_.empty()) return;
  const ObservedScan observed = seen.scan(scanner_);
  if (observed.scan == nullptr || observed.count == seen_) return;
  read_scan(observed);
  seen_ = observed.count;
}

void PointCloudElement::read_scan(const ObservedScan& observed) {
  if (batches_.size() < static_cast<std::size_t>(look_.keep)) {
    add_batch();
  } else {
    // Reuse the nodes of the oldest batch, so that the structure of the graph does not change.
    batches_.push_back(std::move(batches_.front()));
    batches_.pop_front();
  }
  Batch& newest = batches_.back();
  newest.place->set_matrix(observed.world_from_sensor);
  newest.points_m.clear();
  for_each_beam(*observed.scan, 1, [&](const glm::dvec3& origin_m, const glm::dvec3& direction, double range_m) {
    if (is_hit(range_m)) newest.points_m.emplace_back(origin_m + range_m * direction);
  });
  draw(newest);
}

// The nodes of batches stand in another order than their scans were made: it decides which of two points is drawn that
// lie in one place. Points of a file are those of its command.
void PointCloudElement::archive(StateArchive& state) {
  if (scanner_.empty()) return;
  std::unordered_map<const Node*, std::uint64_t> place_of;
  for (const NodePtr& each : batch_nodes_->children()) place_of.emplace(each.get(), place_of.size());
  std::vector<std::uint64_t> places;  // among the batches of the graph, by age
  for (const Batch& each : batches_) places.push_back(place_of.at(each.separator.get()));
  state(seen_, places);
  state.require(places.size() <= static_cast<std::size_t>(kMaxScans));
  if (state.is_reading()) replace_batches(state, places);
  for (Batch& each : batches_) {
    glm::dmat4 world_from_batch = each.place->matrix();
    state.finite(world_from_batch);
    for (glm::length_t axis = 0; axis < 3; ++axis) {
      state.require(std::abs(world_from_batch[3][axis]) <= kMaxCoordinate_m);
    }
    state(each.points_m);
    state.require(
        std::ranges::all_of(each.points_m, [](const glm::vec3& p) { return std::isfinite(p.x + p.y + p.z); }));
    each.place->set_matrix(world_from_batch);
  }
}

void PointCloudElement::replace_batches(const StateArchive& state, std::span<const std::uint64_t> places) {
  std::vector<std::size_t> age(places.size(), places.size());  // by place
  for (std::size_t i = 0; i < places.size(); ++i) {
    state.require(places[i] < places.size() && age[places[i]] == places.size());
    age[places[i]] = i;
  }
  separator_->remove(*batch_nodes_);
  batch_nodes_ = std::make_shared<Group>();
  separator_->add(batch_nodes_);
  batches_.clear();
  std::deque<Batch> by_age(places.size());
  for (const std::size_t each : age) {
    add_batch();
    by_age[each] = std::move(batches_.back());
  }
  batches_ = std::move(by_age);
  stale_ = true;
}

void PointCloudElement::color_points(const Batch& batch, Mesh& mesh, std::size_t count) const {
  const VertexAttributes of_all{.color = {look_.color, 1}};
  if (!batch.colors.empty() || (!mesh.attributes.empty() && mesh.attributes.front() != of_all)) mesh.attributes.clear();
  mesh.attributes.resize(count, of_all);
  if (batch.colors.empty()) return;
  for (std::size_t i = 0; i < count; ++i) mesh.attributes[i].color = {batch.colors[i], 1};
}

// The device draws each point as a square: one vertex, where a solid would take eight triangles. The mesh takes over
// the memory of the one before the last, once nothing else refers to that: new memory for a million points costs as
// much as to draw them.
void PointCloudElement::draw(Batch& batch) {
  const std::size_t count =
      look_.size_m > 0 ? std::min(static_cast<std::size_t>(look_.count), batch.points_m.size()) : 0;
  auto mesh = std::make_shared<Mesh>();
  if (batch.shown_before.use_count() == 1) {
    mesh->positions = std::move(batch.shown_before->positions);
    mesh->attributes = std::move(batch.shown_before->attributes);
    mesh->indices = std::move(batch.shown_before->indices);
  }
  mesh->name = name_;
  mesh->topology = Topology::points;
  mesh->short_lived = true;
  mesh->surface = ExactSurface{.kind = SurfaceKind::sphere, .radius_m = look_.size_m / 2};
  mesh->positions.assign(batch.points_m.begin(), batch.points_m.begin() + static_cast<std::ptrdiff_t>(count));
  color_points(batch, *mesh, count);
  const std::size_t numbered = std::min(mesh->indices.size(), count);
  mesh->indices.resize(count);
  std::iota(mesh->indices.begin() + static_cast<std::ptrdiff_t>(numbered), mesh->indices.end(),
            static_cast<std::uint32_t>(numbered));
  compute_bounds(*mesh);
  batch.shown_before = std::exchange(batch.shown, mesh);
  batch.shape->set_mesh(std::move(mesh));
}

}  // namespace simvis
