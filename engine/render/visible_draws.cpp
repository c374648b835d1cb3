#include "engine/render/visible_draws.h"

#include <algorithm>

namespace simvis {
namespace {

using Surface = PipelineKey::Surface;

// The number of triangles whose drawing costs about as much as occlusion culling.
constexpr std::uint64_t kWorthHiding = 2000;

// The number of triangles of a mesh whose drawing costs about as much as a draw of its own.
constexpr std::uint32_t kWorthSelecting = 64;

// Whether the drawable consists of opaque triangles in a depth pass without items, drawn from both sides. For these
// only the nearest depth counts, so they can be drawn in any order.
bool can_join_strip(const ViewContext& context, const Drawable& d) {
  return !context.pass.items && d.key.depth_only && !d.key.color && d.key.topology == Topology::triangles &&
         d.key.surface == Surface::opaque && (context.view.sees_back_faces || !d.single_sided);
}

bool are_selectable_points(const DrawCandidate& candidate) {
  const PipelineKey& key = candidate.drawable->key;
  return key.topology == Topology::points && key.surface == Surface::opaque &&
         candidate.range->index_count >= kWorthSelectingPoints;
}

glm::dmat4 view_from_mesh(const ViewContext& context, const DrawCandidate& candidate) {
  return context.projection.view_from_world * *candidate.world_from_mesh;
}

MeshPlanes planes_of(const ViewContext& context, const DrawCandidate& candidate) {
  return make_mesh_planes(context.projection, *candidate.world_from_mesh, *candidate.box);
}

}  // namespace

void VisibleDraws::begin(const ViewContext& context) {
  const View& view = context.view;
  const Pass& pass = context.pass;
  const RasterTraits& raster = context.raster;
  indices_.clear();
  copies_.clear();
  copied_vertices_ = triangle_copies_ = 0;
  tolerance_ = FacingTolerance(view, raster.snap_px);
  occlusion_.begin(view, raster.snap_px);
  selects_triangles_ = raster.selects_primitives && cpu_selects_triangles(view, pass);
  if (selects_triangles_) triangles_.begin(view, pass.supersampling * pass.msaa, raster.snap_px, occlusion_);
  selects_points_ = raster.selects_primitives && cpu_selects_points(view, pass);
  if (selects_points_) points_.begin(view, pass.supersampling, raster.snap_px, raster.points);
}

void VisibleDraws::add_occluders(const ViewContext& context, std::span<const DrawCandidate> candidates) {
  if (!context.view.culled || context.strip || context.view.orthographic || context.pass.shadow_maps) return;
  std::uint64_t triangles = 0;
  const Drawable* counted = nullptr;
  for (const DrawCandidate& candidate : candidates) {
    if (candidate.drawable != counted) triangles += candidate.drawable->range.index_count / 3;
    counted = candidate.drawable;
  }
  if (triangles < kWorthHiding) return;
  for (const DrawCandidate& candidate : candidates) {
    const Drawable& d = *candidate.drawable;
    if (d.range.occluders.empty() || d.key.surface != Surface::opaque) continue;
    const ViewBox box = view_box(context.projection, *candidate.box);
    if (!occlusion_.may_hold_occluders(box)) continue;
    occlusion_.add(candidate.range->occluders, view_from_mesh(context, candidate), box.slack_m, context.culls_backs(d),
                   d.mirrored);
  }
}

std::span<const VisibleDraw> VisibleDraws::cull(const ViewContext& context, std::span<const DrawCandidate> candidates) {
  visible_.clear();
  for (std::uint32_t number = 0; number < candidates.size(); ++number) {
    const DrawCandidate& candidate = candidates[number];
    if (context.strip && can_join_strip(context, *candidate.drawable)) {
      add_to_strip(context, candidate, number);
    } else if (is_hidden(context, candidate)) {
      ++context.draws.items_culled;
    } else if (selects_points_ && are_selectable_points(candidate)) {
      select_points(context, candidate);
    } else if (!context.view.culled || candidate.range->clusters.size() == 1) {
      visible_.push_back({.candidate = &candidate});
    } else if (context.strip) {
      add_in_strip(context, candidate);
    } else {
      add_clusters(context, candidate);
    }
  }
  return visible_;
}

bool VisibleDraws::is_hidden(const ViewContext& context, const DrawCandidate& candidate) const {
  return occlusion_.any() && candidate.drawable->key.topology == Topology::triangles &&
         occlusion_.is_occluded(view_box(context.projection, *candidate.box), view_from_mesh(context, candidate),
                                *candidate.range);
}

void VisibleDraws::add_to_strip(const ViewContext& context, const DrawCandidate& candidate, std::uint32_t number) {
  const MeshRange& mesh = *candidate.range;
  const MeshPlanes planes = planes_of(context, candidate);
  context.strip->place(number, view_from_mesh(context, candidate), planes.slack);
  context.draws.counts.boxes_examined += mesh.clusters.size();
  for (const Cluster& cluster : mesh.clusters) {
    if (outside(planes, cluster.center, cluster.half_size)) continue;
    context.draws.counts.triangles_examined += cluster.index_count / 3;
    context.strip->add(mesh.clustering->vertices_of(cluster), mesh.clustering->corners_of(cluster), mesh.positions);
  }
}

// A strip intersects few triangles even of its visible clusters, and drawing one of the other triangles costs the
// device more than a test on the host. So only triangles that may intersect the strip are drawn, in one draw with its
// own indices.
void VisibleDraws::add_in_strip(const ViewContext& context, const DrawCandidate& candidate) {
  const MeshRange& mesh = *candidate.range;
  const MeshPlanes planes = planes_of(context, candidate);
  const std::size_t first = indices_.size();
  context.draws.counts.boxes_examined += mesh.clusters.size();
  for (const Cluster& cluster : mesh.clusters) {
    if (outside(planes, cluster.center, cluster.half_size)) continue;
    context.draws.counts.triangles_examined += cluster.index_count / 3;
    const ClusterVertices vertices = mesh.clustering->vertices_of(cluster);
    const std::span<const std::uint8_t> corners = mesh.clustering->corners_of(cluster);
    for (std::size_t i = 0; i < corners.size(); i += 3) {
      const std::uint32_t a = vertices[corners[i]], b = vertices[corners[i + 1]], c = vertices[corners[i + 2]];
      const auto& p = mesh.positions;
      if (!outside(planes, p[a], p[b], p[c])) indices_.insert(indices_.end(), {a, b, c});
    }
  }
  add_triangles_from(candidate, first);
}

void VisibleDraws::add_clusters(const ViewContext& context, const DrawCandidate& candidate) {
  const MeshRange& mesh = *candidate.range;
  const MeshPlanes planes = planes_of(context, candidate);
  const glm::dmat4 view_from = view_from_mesh(context, candidate);
  const bool culls_backs = context.culls_backs(*candidate.drawable);
  const NormalConeCuller eye(tolerance_, planes, view_from);
  const bool by_facing = culls_backs && eye.is_usable() && !mesh.facing.empty();
  seen_clusters_.clear();
  std::uint32_t seen_indices = 0;
  context.draws.counts.boxes_examined += mesh.clusters.size();
  for (std::size_t i = 0; i < mesh.clusters.size(); ++i) {
    const Cluster& cluster = mesh.clusters[i];
    if (outside(planes, cluster.center, cluster.half_size)) continue;
    if (by_facing && eye.is_backfacing(cluster, mesh.facing[i])) continue;
    if (occlusion_.any() &&
        occlusion_.is_occluded(view_box(view_from, cluster, planes.slack), view_from, mesh, cluster)) {
      continue;
    }
    seen_indices += cluster.index_count;
    seen_clusters_.push_back(&cluster);
  }
  const bool partly_hidden =
      selects_triangles_ && occlusion_.hides_middle(view_box(context.projection, *candidate.box));
  if (selects_triangles_ && (partly_hidden || seen_indices >= 3 * kWorthSelecting || !mesh.resident)) {
    triangles_.place(view_from, planes.slack, culls_backs, candidate.drawable->mirrored, partly_hidden);
    select_triangles(context, candidate);
  } else if (!seen_clusters_.empty() && seen_indices == mesh.index_count) {
    visible_.push_back({.candidate = &candidate});
  } else {
    add_seen_clusters(candidate);
  }
}

// Adds one draw for each sequence of consecutive visible clusters.
void VisibleDraws::add_seen_clusters(const DrawCandidate& candidate) {
  const std::size_t before = visible_.size();
  for (const Cluster* const cluster : seen_clusters_) {
    const std::uint32_t first = candidate.range->first_index + cluster->first_index;
    if (visible_.size() > before && visible_.back().first + visible_.back().count == first) {
      visible_.back().count += cluster->index_count;
    } else {
      visible_.push_back({&candidate, VisibleDraw::Kind::clusters, first, cluster->index_count});
    }
  }
}

// Adds those triangles of the seen clusters that can change a pixel.
void VisibleDraws::select_triangles(const ViewContext& context, const DrawCandidate& candidate) {
  const MeshRange& mesh = *candidate.range;
  const std::size_t first = indices_.size();
  std::vector<std::uint32_t>* const copied = mesh.resident ? nullptr : &next_copied();
  for (const Cluster* const cluster : seen_clusters_) {
    const std::size_t first_of_cluster = indices_.size();
    context.draws.counts.triangles_examined += cluster->index_count / 3;
    triangles_.select(mesh.clustering->vertices_of(*cluster), mesh.clustering->corners_of(*cluster), mesh.positions,
                      indices_);
    if (copied != nullptr) copy_corners(first_of_cluster, *copied);
  }
  if (copied == nullptr) return add_triangles_from(candidate, first);
  triangle_copies_ += copied->size();
  add_copies(context, candidate,
             {.kind = VisibleDraw::Kind::copied_triangles,
              .first = static_cast<std::uint32_t>(first),
              .count = static_cast<std::uint32_t>(indices_.size() - first),
              .first_vertex = static_cast<std::uint32_t>(copied_vertices_)});
}

// Copies the corners of a cluster's triangles, each vertex once, and lets the indices count in the copies.
void VisibleDraws::copy_corners(std::size_t first_index, std::vector<std::uint32_t>& copied) {
  const auto first = static_cast<std::ptrdiff_t>(copied.size());
  for (std::uint32_t& index : std::span(indices_).subspan(first_index)) {
    const auto known = std::find(copied.begin() + first, copied.end(), index);
    const auto place = static_cast<std::uint32_t>(known - copied.begin());
    if (known == copied.end()) copied.push_back(index);
    index = place;
  }
}

void VisibleDraws::add_triangles_from(const DrawCandidate& candidate, std::size_t first_index) {
  if (indices_.size() == first_index) return;
  visible_.push_back({&candidate, VisibleDraw::Kind::triangles, static_cast<std::uint32_t>(first_index),
                      static_cast<std::uint32_t>(indices_.size() - first_index)});
}

void VisibleDraws::select_points(const ViewContext& context, const DrawCandidate& candidate) {
  const Drawable& d = *candidate.drawable;
  const Mesh& mesh = *context.list.meshes[context.list.items[d.item].mesh];
  points_.select(view_from_mesh(context, candidate), planes_of(context, candidate).slack, d.point_m, mesh.positions,
                 mesh.indices, next_copied());
  add_copies(context, candidate,
             {.kind = VisibleDraw::Kind::points,
              .first = static_cast<std::uint32_t>(copied_vertices_),
              .count = static_cast<std::uint32_t>(copied_[copies_.size()].size())});
}

// Returns an empty list for add_copies().
std::vector<std::uint32_t>& VisibleDraws::next_copied() {
  if (copied_.size() == copies_.size()) copied_.emplace_back();
  copied_[copies_.size()].clear();
  return copied_[copies_.size()];
}

// Adds a draw of copies of the vertices in the list that next_copied() has returned.
void VisibleDraws::add_copies(const ViewContext& context, const DrawCandidate& candidate, const VisibleDraw& draw) {
  const std::span<const std::uint32_t> vertices = copied_[copies_.size()];
  if (vertices.empty()) return;
  const Drawable& d = *candidate.drawable;
  copies_.push_back({context.list.meshes[context.list.items[d.item].mesh].get(), vertices, d.key.color});
  copied_vertices_ += vertices.size();
  visible_.push_back(draw);
  visible_.back().candidate = &candidate;
}

}  // namespace simvis
