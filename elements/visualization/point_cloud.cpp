#include "elements/visualization/point_cloud.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "elements/visualization/scan_hits.h"
#include "engine/base/read_error.h"

namespace simvis {
namespace {

constexpr AttributeSpec kPointCloudAttributes[] = {
    {.name = "file", .kind = AttributeKind::text, .text = ".csv or .xyz file with points \"x y z\" or \"x y z r g b\""},
    {.name = "scanner", .kind = AttributeKind::sensor, .text = "name of a laser scanner, instead of file"},
    {.name = "count",
     .kind = AttributeKind::number,
     .default_value = "1000000",
     .text = "number of points of the file or of each scan that are drawn, from the first; rounded down",
     .min = 0,
     .max = kMaxPoints,
     .live = true},
    marker_size_row("size", "0.04", "size of a point; 0: not drawn"),
    {.name = "keep",
     .kind = AttributeKind::number,
     .default_value = "1",
     .text = "number of the scanner's last scans that are drawn; rounded down",
     .min = 1,
     .max = 10000,
     .live = true},
    color_row("red", "0", "red of points that have no colour of their own"),
    color_row("green", "0.6", "green of points that have no colour of their own"),
    color_row("blue", "0.9", "blue of points that have no colour of their own"),
};

const ElementRegistration kPointCloudRegistration({
    .name = "point_cloud",
    .summary = "Draws points from a file, or the points that a laser scanner hit.",
    .notes = "Only cameras with view=\"visualization\" show it; simulated sensors never see it.\nA scene gives either "
             "file or scanner. Points of a file stand in the frame of the insertion point, points of a scanner in the "
             "world. A file has at most a million lines \"x y z\" or \"x y z r g b\" (metres; sRGB from 0 to 255), "
             "separated by spaces or commas.",
    .attributes = kPointCloudAttributes,
    .create = [](const ElementContext& context) -> std::unique_ptr<Element> {
      return std::make_unique<PointCloudElement>(context);
    },
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
    : name_(context.command.require("name").value), separator_(std::make_shared<VisualSeparator>()) {
  const Command& command = context.command;
  const CommandAttribute* const scanner = command.find("scanner");
  if ((scanner != nullptr) == (command.find("file") != nullptr)) {
    fail_at(command.where, "expected exactly one of the attributes \"file\" and \"scanner\"");
  }
  separator_->name = name_;
  separator_->add(std::make_shared<MaterialNode>(marker_material(AlphaMode::opaque)));
  if (scanner != nullptr) {
    scanner_ = scanner->value;
    context.scene.insert_in_world(command, separator_);
  } else {
    add_file(context);
    context.scene.insert(command, separator_);
  }
}

void PointCloudElement::add_file(const ElementContext& context) {
  PointFile file = read_point_file(find_point_file(context));
  has_colors_ = file.has_colors;
  const glm::dvec3 origin = file.points.front().position_m;  // maps may lie far from the origin
  for (FilePoint& point : file.points) point.position_m -= origin;
  Batch& batch = add_batch();
  batch.points = std::move(file.points);
  glm::dmat4 frame_from_mesh{1.0};
  frame_from_mesh[3] = {origin, 1};
  batch.place->set_matrix(frame_from_mesh);
}

PointCloudElement::Batch& PointCloudElement::add_batch() {
  Batch& batch = batches_.emplace_back(Batch{.separator = std::make_shared<Separator>(),
                                             .place = std::make_shared<Transform>(),
                                             .shape = std::make_shared<Shape>(MarkerMesh().take(name_)),
                                             .points = {}});
  batch.separator->add(batch.place);
  batch.separator->add(batch.shape);
  separator_->add(batch.separator);
  return batch;
}

void PointCloudElement::update(ParameterView values) {
  count_ = static_cast<std::size_t>(values[0]);
  size_m_ = values[1];
  keep_ = static_cast<std::size_t>(values[2]);
  color_ = {values[3], values[4], values[5]};
  for (; batches_.size() > keep_; batches_.pop_front()) separator_->remove(*batches_.front().separator);
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
  if (batches_.size() < keep_) {
    add_batch();
  } else {
    // Reuse the nodes of the oldest batch, so that the structure of the graph does not change.
    batches_.push_back(std::move(batches_.front()));
    batches_.pop_front();
  }
  Batch& newest = batches_.back();
  newest.place->set_matrix(observed.world_from_sensor);
  newest.points.clear();
  for_each_beam(*observed.scan, 1, [&](const glm::dvec3& origin_m, const glm::dvec3& direction, double range_m) {
    if (is_hit(range_m)) newest.points.push_back({.position_m = origin_m + range_m * direction});
  });
  draw(newest);
}

// The device draws each point as a square: one vertex, where a solid would take eight triangles.
void PointCloudElement::draw(Batch& batch) {
  const std::size_t count = size_m_ > 0 ? std::min(count_, batch.points.size()) : 0;
  auto mesh = std::make_shared<Mesh>();
  mesh->name = name_;
  mesh->topology = Topology::points;
  mesh->short_lived = true;
  mesh->surface = ExactSurface{.kind = SurfaceKind::sphere, .radius_m = size_m_ / 2};
  mesh->positions.resize(count);
  mesh->attributes.resize(count);
  mesh->indices.resize(count);
  std::iota(mesh->indices.begin(), mesh->indices.end(), 0u);
  for (std::size_t i = 0; i < count; ++i) {
    const FilePoint& point = batch.points[i];
    mesh->positions[i] = point.position_m;
    mesh->attributes[i].color = {has_colors_ ? point.color : color_, 1};
  }
  compute_bounds(*mesh);
  batch.shape->set_mesh(std::move(mesh));
}

}  // namespace simvis
