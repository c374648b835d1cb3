// Second stage of a view's draws: what the view shows of each candidate. Occluded meshes and clusters are culled, and
// where the host tests single triangles and points, these too. No pixel that is read changes.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "engine/culling/occlusion_culler.h"
#include "engine/culling/triangle_selector.h"
#include "engine/render/draw_candidates.h"

namespace simvis {

/// A candidate, or a part of one, that the view shows.
struct VisibleDraw {
  enum class Kind : std::uint8_t {
    mesh,              ///< the whole range of the candidate
    clusters,          ///< consecutive clusters: `first` counts indices of the geometry pool
    triangles,         ///< triangles that the host selected: `first` counts in VisibleDraws::indices()
    copied_triangles,  ///< the same; their indices count in the vertices of copies(), from `first_vertex` on
    points             ///< points that the host selected: `first` counts in the vertices of copies()
  };
  const DrawCandidate* candidate = nullptr;
  Kind kind = Kind::mesh;
  std::uint32_t first = 0, count = 0;  ///< of all but whole meshes
  std::uint32_t first_vertex = 0;      ///< of copied triangles
};

/// Keeps its memory from view to view.
class VisibleDraws {
 public:
  void begin(const ViewContext& context);

  /// Adds opaque candidates as occluders of later calls of cull(), if the view supports occlusion culling and has
  /// enough triangles for it to pay off.
  void add_occluders(const ViewContext& context, std::span<const DrawCandidate> candidates);

  /// Returns what the view shows, in the order of the candidates. Valid until the next call. In a strip, those whose
  /// order has no effect go to context.strip instead, with their number as the owner.
  std::span<const VisibleDraw> cull(const ViewContext& context, std::span<const DrawCandidate> candidates);

  /// What cull() has selected since begin().
  std::span<const std::uint32_t> indices() const { return indices_; }
  /// In the order of their draws.
  std::span<const VertexCopies> copies() const { return copies_; }
  /// The number of vertices of all copies.
  std::size_t copied_vertices() const { return copied_vertices_; }
  /// Of these, vertices of triangles: see FrameDrawLists::triangle_copies().
  std::size_t triangle_copies() const { return triangle_copies_; }

 private:
  bool is_hidden(const ViewContext& context, const DrawCandidate& candidate) const;
  void add_to_strip(const ViewContext& context, const DrawCandidate& candidate, std::uint32_t number);
  void add_in_strip(const ViewContext& context, const DrawCandidate& candidate);
  void add_clusters(const ViewContext& context, const DrawCandidate& candidate);
  void add_seen_clusters(const DrawCandidate& candidate);
  void select_triangles(const ViewContext& context, const DrawCandidate& candidate);
  void select_points(const ViewContext& context, const DrawCandidate& candidate);
  void add_triangles_from(const DrawCandidate& candidate, std::size_t first_index);
  std::vector<std::uint32_t>& next_copied();
  void copy_corners(std::size_t first_index, std::vector<std::uint32_t>& copied);
  void add_copies(const ViewContext& context, const DrawCandidate& candidate, const VisibleDraw& draw);

  FacingTolerance tolerance_;                                // of the view
  OcclusionCuller occlusion_;                                // used if the view is not a strip
  TriangleSelector triangles_;                               // used if selects_triangles_
  PointSelector points_;                                     // used if selects_points_
  bool selects_triangles_ = false, selects_points_ = false;  // in the present view
  std::vector<const Cluster*> seen_clusters_;                // of one candidate
  std::vector<std::uint32_t> indices_;
  std::vector<VertexCopies> copies_;
  std::deque<std::vector<std::uint32_t>> copied_;  // by copy; earlier views may have needed more
  std::size_t copied_vertices_ = 0, triangle_copies_ = 0;
  std::vector<VisibleDraw> visible_;
};

}  // namespace simvis
