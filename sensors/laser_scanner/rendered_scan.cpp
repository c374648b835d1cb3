#include "sensors/laser_scanner/rendered_scan.h"

#include <utility>

namespace simvis {

namespace {

// A tenth of a millimetre: a surface that touches the scanner is still visible, and reversed depth loses no precision.
constexpr double kNear_m = 1e-4;

}  // namespace

RenderedScan::RenderedScan(const ScanPattern& pattern, double resolution_px)
    : resolution_px_(resolution_px), layout_(make_scan_layout(pattern, resolution_px)) {}

void RenderedScan::plan(const std::string& scanner, const std::string& purpose, const glm::dmat4& sensor_from_world,
                        FramePlan& plan, const std::string& atlas) {
  places_.clear();
  for (std::size_t f = 0; f < layout_.faces.size(); ++f) {
    const ScanFace& face = layout_.faces[f];
    View view;
    view.name = scanner + "/face " + std::to_string(f);
    view.reason = std::to_string(face.beams) + " beams of laser scanner " + scanner + purpose;
    view.pinhole = face.pinhole;
    view.near_m = kNear_m;
    view.view_from_world = glm::dmat4(face.face_from_sensor) * sensor_from_world;
    view.width_px = face.width_px;
    view.height_px = face.height_px;
    view.sees_back_faces = true;
    view.sees_lines_and_points = false;
    view.columns = face.columns;
    places_.push_back(place_in_depth_atlas(plan, atlas, std::move(view)));
  }
}

void RenderedScan::collect(const FramePlan& plan, std::span<const PassResult> results, const VertexRounding& rounding,
                           const ShapeRanges* shapes) {
  rounding_ = rounding;
  shapes_ = shapes;
  pixels_.clear();
  counts_ = {};
  for (std::size_t f = 0; f < layout_.faces.size(); ++f) {
    const Pass& pass = plan.passes[places_[f].pass];
    const PassResult& result = results[places_[f].pass];
    pixels_.push_back(face_pixels(result, pass, pass.views[places_[f].view]));
    const ViewCounts& view = result.views[places_[f].view];
    counts_.draws += view.draws;
    counts_.triangles += view.triangles;
    counts_.masked_triangles += view.masked_triangles;
    counts_.boxes_examined += view.boxes_examined;
    counts_.triangles_examined += view.triangles_examined;
  }
}

RangeEstimate RenderedScan::planar(std::size_t beam) const {
  const BeamTap& tap = layout_.taps[beam];
  const RangeEstimate drawn = planar_range(pixels_[tap.face], tap, rounding_);
  return shapes_ == nullptr ? drawn : shapes_->widened(beam, drawn);
}

RangeEstimate RenderedScan::nearest(std::size_t beam) const {
  const BeamTap& tap = layout_.taps[beam];
  return nearest_range(pixels_[tap.face], tap, layout_.faces[tap.face], planar(beam));
}

CostModel RenderedScan::work(std::size_t list_items) const {
  CostModel work;
  work[CostTerm::pass] = 1;
  work[CostTerm::view] = static_cast<double>(layout_.faces.size());
  work[CostTerm::item_drawn] = static_cast<double>(list_items);
  work[CostTerm::examined] = static_cast<double>(counts_.boxes_examined + counts_.triangles_examined);
  work[CostTerm::draw] = static_cast<double>(counts_.draws);
  work[CostTerm::triangle] = static_cast<double>(counts_.triangles - counts_.masked_triangles);
  work[CostTerm::masked] = static_cast<double>(counts_.masked_triangles);
  for (const ScanFace& face : layout_.faces) work[CostTerm::pixel] += 1.0 * face.width_px * face.height_px;
  work[CostTerm::beam] = static_cast<double>(layout_.taps.size());
  return work;
}

}  // namespace simvis
