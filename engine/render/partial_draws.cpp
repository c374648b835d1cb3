// The draws of meshes of which a view sees a part: of single triangles and of clusters.
#include "engine/render/view_draw_list.h"

#include <algorithm>

#include "engine/draw/round_mesh.h"

namespace simvis {
namespace {

// The number of triangles of a mesh whose drawing costs about as much as a draw of its own.
constexpr std::uint32_t kWorthSelecting = 64;

}  // namespace

// A strip intersects few triangles even of its visible clusters, and drawing one of the other triangles costs the
// device more than a test on the host. So only triangles that may intersect the strip are drawn, in one draw with its
// own indices.
void ViewDrawList::draw_seen_triangles(const Drawable& d, const View& view, const ViewProjection& projection,
                                       const DrawList& list, const WorldBox& box) {
  const MeshPlanes planes = make_mesh_planes(projection, place_of(d, list), box);
  const auto first = static_cast<std::uint32_t>(indices_.size());
  draws_.counts.boxes_examined += d.range.clusters.size();
  for (const Cluster& cluster : d.range.clusters) {
    if (outside(planes, cluster.center, cluster.half_size)) continue;
    draws_.counts.triangles_examined += cluster.index_count / 3;
    const std::span<const std::uint32_t> vertices = d.range.clustering->vertices_of(cluster);
    const std::span<const std::uint8_t> corners = d.range.clustering->corners_of(cluster);
    for (std::size_t i = 0; i < corners.size(); i += 3) {
      const std::uint32_t a = vertices[corners[i]], b = vertices[corners[i + 1]], c = vertices[corners[i + 2]];
      const auto& p = d.range.positions;
      if (!outside(planes, p[a], p[b], p[c])) indices_.insert(indices_.end(), {a, b, c});
    }
  }
  const auto count = static_cast<std::uint32_t>(indices_.size() - first);
  if (count == 0) return;
  const MeshRange range{.first_index = first, .index_count = count, .vertex_offset = d.range.vertex_offset};
  add_run(d, key_in_view(d, view, list), range, add_instance(d, projection, list)).own_indices = true;
  last_group_ = kNoGroup;
}

// Whether the drawable consists of opaque triangles in a depth pass without items, drawn from both sides. For these
// only the nearest depth counts, so they can be drawn in any order.
bool ViewDrawList::can_cpu_select(const Drawable& d, const View& view) const {
  return !names_items_ && d.key.depth_only && !d.key.color && d.key.topology == Topology::triangles &&
         d.key.surface == PipelineKey::Surface::opaque && (view.sees_back_faces || !d.single_sided);
}

void ViewDrawList::add_to_strip(const Drawable& d, std::uint32_t number, const ViewProjection& projection,
                                const DrawList& list, const WorldBox& box) {
  const glm::dmat4& world_from_mesh = place_of(d, list);
  const MeshPlanes planes = make_mesh_planes(projection, world_from_mesh, box);
  strip_->place(number, projection.view_from_world * world_from_mesh, planes.slack);
  draws_.counts.boxes_examined += d.range.clusters.size();
  for (const Cluster& cluster : d.range.clusters) {
    if (outside(planes, cluster.center, cluster.half_size)) continue;
    draws_.counts.triangles_examined += cluster.index_count / 3;
    strip_->add(d.range.clustering->vertices_of(cluster), d.range.clustering->corners_of(cluster), d.range.positions);
  }
}

// Draws all triangles of the strip with one draw.
void ViewDrawList::draw_strip(const RenderQueue& items, const View& view, const ViewProjection& projection,
                              const DrawList& list) {
  const std::span<const StripTriangle> seen = strip_->visible();
  if (seen.empty()) return;
  const auto first = static_cast<std::uint32_t>(cpu_selected_.size());
  shader::CpuSelectedVertex vertex{};
  const Drawable* owner = nullptr;
  std::span<const glm::vec3> vertices;
  for (const StripTriangle& triangle : seen) {
    if (owner != &items[triangle.owner]) {
      owner = &items[triangle.owner];
      const auto round = std::ranges::lower_bound(strip_round_, triangle.owner, {}, &StripRound::position);
      const bool is_round = round != strip_round_.end() && round->position == triangle.owner;
      vertices = is_round ? round->vertices : owner->range.positions;
      shader::Instance instance{};
      write_clip_rows(projection, place_of(*owner, list), instance);
      vertex.clip_x = instance.clip_x;
      vertex.clip_y = instance.clip_y;
      vertex.clip_w = instance.clip_w;
    }
    for (int i = 0; i < 3; ++i) {
      const glm::vec3& p = vertices[triangle.corners[i]];
      vertex.x = p.x;
      vertex.y = p.y;
      vertex.z = p.z;
      cpu_selected_.push_back(vertex);
    }
  }
  PipelineKey key = key_in_view(*owner, view, list);
  key.cpu_selected = true;
  runs_.push_back(
      {.key = key,
       .range = {.first_index = first, .index_count = static_cast<std::uint32_t>(cpu_selected_.size()) - first},
       .instance_count = 1});
  last_group_ = kNoGroup;
}

// Adds one draw for each sequence of consecutive visible clusters. If all clusters are visible, draw() draws the whole
// mesh.
void ViewDrawList::draw_seen_clusters(const Drawable& d, const View& view, const ViewProjection& projection,
                                      const DrawList& list, const WorldBox& box, std::size_t first_run) {
  const glm::dmat4& world_from_mesh = place_of(d, list);
  const MeshPlanes planes = make_mesh_planes(projection, world_from_mesh, box);
  const PipelineKey key = key_in_view(d, view, list);
  const glm::dmat4 view_from_mesh = projection.view_from_world * world_from_mesh;
  const NormalConeCuller eye(limit_, planes, view_from_mesh);
  const bool by_facing = key.cull_back && eye.is_usable() && !d.range.facing.empty();
  seen_.clear();
  seen_clusters_.clear();
  std::uint32_t seen_indices = 0;
  draws_.counts.boxes_examined += d.range.clusters.size();
  for (std::size_t i = 0; i < d.range.clusters.size(); ++i) {
    const Cluster& cluster = d.range.clusters[i];
    if (outside(planes, cluster.center, cluster.half_size)) continue;
    if (by_facing && eye.is_backfacing(cluster, d.range.facing[i])) continue;
    if (hidden_.any() &&
        hidden_.is_occluded(view_box(view_from_mesh, cluster, planes.slack), view_from_mesh, d.range, cluster)) {
      continue;
    }
    seen_indices += cluster.index_count;
    if (selecting_) seen_clusters_.push_back(&cluster);
    if (!seen_.empty() && seen_.back().first_index + seen_.back().index_count == cluster.first_index) {
      seen_.back().index_count += cluster.index_count;
    } else {
      seen_.push_back({.first_index = cluster.first_index, .index_count = cluster.index_count});
    }
  }
  if (seen_.empty()) return;
  if (selecting_ && seen_indices >= 3 * kWorthSelecting) {
    selector_.place(view_from_mesh, planes.slack, key.cull_back, d.mirrored);
    draw_selected_triangles(d, key, projection, list);
    return;
  }
  if (seen_.front().index_count == d.range.index_count) {
    draw(d, view, projection, list, first_run);
    return;
  }
  const std::uint32_t instance = add_instance(d, projection, list);
  for (MeshRange& part : seen_) {
    part.first_index += d.range.first_index;
    part.vertex_offset = d.range.vertex_offset;
    part.bounds_min = d.range.bounds_min;
    part.bounds_max = d.range.bounds_max;
    add_run(d, key, part, instance);
  }
  last_group_ = kNoGroup;
}

bool ViewDrawList::can_select_points(const Drawable& d) const {
  return selecting_points_ && d.key.topology == Topology::points && d.key.surface == PipelineKey::Surface::opaque &&
         d.range.index_count >= kWorthSelectingPoints;
}

void ViewDrawList::draw_selected_points(const Drawable& d, const View& view, const ViewProjection& projection,
                                        const DrawList& list, const WorldBox& box) {
  const glm::dmat4& world_from_mesh = place_of(d, list);
  const double slack_m = make_mesh_planes(projection, world_from_mesh, box).slack;
  const Mesh& mesh = *list.meshes[list.items[d.item].mesh];
  selected_points_.clear();
  point_selector_.select(projection.view_from_world * world_from_mesh, slack_m, d.point_m, mesh.positions, mesh.indices,
                         selected_points_);
  if (selected_points_.empty()) return;
  const MeshRange range{.first_index = static_cast<std::uint32_t>(point_positions_.size()),
                        .index_count = static_cast<std::uint32_t>(selected_points_.size())};
  for (const std::uint32_t point : selected_points_) point_positions_.push_back(mesh.positions[point]);
  if (d.key.color) append_packed(mesh.attributes, selected_points_, point_attributes_);
  add_run(d, key_in_view(d, view, list), range, add_instance(d, projection, list)).own_points = true;
  last_group_ = kNoGroup;
}

// Draws those triangles of the seen clusters that can change a pixel, in one draw with its own indices.
void ViewDrawList::draw_selected_triangles(const Drawable& d, const PipelineKey& key, const ViewProjection& projection,
                                           const DrawList& list) {
  const auto first = static_cast<std::uint32_t>(indices_.size());
  for (const Cluster* const cluster : seen_clusters_) {
    draws_.counts.triangles_examined += cluster->index_count / 3;
    selector_.select(d.range.clustering->vertices_of(*cluster), d.range.clustering->corners_of(*cluster),
                     d.range.positions, indices_);
  }
  const auto count = static_cast<std::uint32_t>(indices_.size()) - first;
  if (count == 0) return;
  const MeshRange range{.first_index = first, .index_count = count, .vertex_offset = d.range.vertex_offset};
  add_run(d, key, range, add_instance(d, projection, list)).own_indices = true;
  last_group_ = kNoGroup;
}

}  // namespace simvis
