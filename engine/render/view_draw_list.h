// The draws of one view after culling: instances, lights and runs of instanced draws.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/frame_plan.h>
#include <simvis/frame_results.h>
#include "engine/culling/column_occlusion_buffer.h"
#include "engine/culling/occlusion_culler.h"
#include "engine/culling/point_selector.h"
#include "engine/culling/strip_columns.h"
#include "engine/culling/triangle_selector.h"
#include "engine/render/draw_cache.h"
#include "shaders/interop.h"

namespace simvis {

/// Whether the view is a strip: culled and at least eight times as wide as high (see guard_rows()). The host then tests
/// single triangles.
bool is_strip(const View& view);

/// Whether the host of a CPU device selects the points of large clouds that the view sees. The view then needs no
/// device copy of these meshes if they are opaque.
bool cpu_selects_points(const View& view, const Pass& pass);

/// Whether the host selects all opaque triangles that the view draws. The view then needs no device copy of these
/// meshes.
bool cpu_selects_opaque(const View& view);

/// How the device draws.
struct RasterTraits {
  double snap_px = 0;               ///< as in PassResult
  PointSizes points;                ///< of points with a size
  bool selects_primitives = false;  ///< the host selects single triangles and points of all culled views, because
                                    ///< drawing one costs the device more than testing it costs the host
};

/// One instanced draw.
struct DrawRun {
  PipelineKey key;
  VkDescriptorSet texture = VK_NULL_HANDLE;
  MeshRange range;
  std::uint32_t first_instance = 0, instance_count = 0;
  bool depth_visible = true;  ///< visible to depth passes and sensors
  float point_m = 0;          ///< as in Drawable
  bool own_indices = false;   ///< range.first_index counts in indices(), not in the geometry pool.
                              ///< With key.cpu_selected, it counts in cpu_selected(), without indices.
  bool own_points = false;    ///< range.first_index counts in point_positions(), without indices

  /// Of all instances; 0 for lines and points.
  std::uint64_t triangles() const {
    return key.topology == Topology::triangles ? std::uint64_t{range.index_count / 3} * instance_count : 0;
  }
};

/// Pixels of a view, from the first ones to those before the last ones. Empty if not first < last.
struct PixelRect {
  glm::uvec2 first{0}, last{0};

  bool empty() const { return first.x >= last.x || first.y >= last.y; }
  bool operator==(const PixelRect&) const = default;
};

/// The phases in which the runs of a view are drawn.
enum class DrawPhase : std::uint8_t { solid, layers, depth_visible };
inline constexpr std::uint32_t kDrawPhases = 3;

/// The runs of one view: [first_run, first_layer) are solid, [first_layer, first_depth_visible) are transparent, and
/// [first_depth_visible, end_run) repeat the depth-visible transparent runs for depth.
struct ViewDraws {
  shader::ViewBlock block;
  std::size_t shadowed = 0;  ///< index among the views with shadows, if it has any; see ShadowMaps::first_texel()
  std::size_t first_run = 0, first_layer = 0, first_depth_visible = 0, end_run = 0;
  PixelRect layered;               ///< holds all pixels that show a transparent surface; relative to the view
  std::vector<DrawnLevel> levels;  ///< see View::levels
  ViewCounts counts;
};

/// The lists keep their memory from view to view. All indices refer to the lists of this object.
class ViewDrawList {
 public:
  explicit ViewDrawList(const RasterTraits& raster) : raster_(raster) {}

  /// Builds the draws of one view and replaces those of the previous view. `columns` are the columns of the view if it
  /// is a strip, and null otherwise; `strip` is used only with `columns`. Several threads may call this on different
  /// objects with the same list and table.
  void update(const View& view, const Pass& pass, const StripColumns* columns, const DrawList& list,
              const DrawCache& table, ColumnOcclusionBuffer& strip);

  const ViewDraws& draws() const { return draws_; }
  std::span<const DrawRun> runs() const { return runs_; }
  std::span<const shader::Instance> instances() const { return instances_; }
  /// By instance: its item in DrawList::items; empty unless the pass has items.
  std::span<const std::uint32_t> items() const { return items_; }
  std::span<const shader::LightBlock> lights() const { return lights_; }
  std::span<const std::uint32_t> indices() const { return indices_; }
  std::span<const shader::CpuSelectedVertex> cpu_selected() const { return cpu_selected_; }
  /// The selected points. Attributes are as many as positions, or empty in a view without colour.
  std::span<const glm::vec3> point_positions() const { return point_positions_; }
  std::span<const PackedAttributes> point_attributes() const { return point_attributes_; }
  std::uint64_t items_culled() const { return items_culled_; }
  /// Levels of round shapes that the view needs and that the table does not have, in any order; one may occur several
  /// times. The view is not complete unless there are none.
  std::span<const LackingLevel> lacking() const { return lacking_; }

 private:
  void add_lights(const View& view, const ViewProjection& projection, const DrawList& list, const DrawCache& table);
  /// A level of a drawable, and the bound on its error in the view.
  struct ChosenLevel {
    const LevelRange* level = nullptr;  ///< null: the mesh itself
    double error_px = 0;
    float error_m = 0;       ///< in the world
    std::uint64_t view = 0;  ///< the value of views_ when it was chosen
  };
  ChosenLevel choose_level(const Drawable& d, std::size_t tile, const View& view, const ViewProjection& projection,
                           const DrawList& list, const DrawCache& table);
  void count_level(const LevelledRange& tile, const ChosenLevel& chosen);
  void add_tiles(const Drawable& d, std::uint32_t position, const View& view, const ViewProjection& projection,
                 const DrawList& list, const DrawCache& table, std::size_t first_run);
  std::size_t add_round(const RenderQueue& items, std::size_t first, const View& view, const ViewProjection& projection,
                        const DrawList& list, const DrawCache& table, std::size_t first_run);
  RoundLevel choose_round(const Drawable& d, const View& view, const ViewProjection& projection, const DrawList& list,
                          const DrawCache& table);
  const MeshRange* round_range(const Drawable& d, const RoundLevel& level, const DrawList& list);
  void count_round(const Drawable& d, const RoundLevel& chosen, const View& view);
  DrawnLevel& counted_level(std::uint32_t number);
  void add_item(const Drawable& d, std::uint32_t position, const View& view, const ViewProjection& projection,
                const DrawList& list, const WorldBox& box, std::size_t first_run);
  void add_occluders(const Drawable& d, const MeshRange& drawn, const ViewBox& box, const View& view,
                     const ViewProjection& projection, const DrawList& list);
  void draw(const Drawable& d, const View& view, const ViewProjection& projection, const DrawList& list,
            std::size_t first_run);
  void find_occluders(const RenderQueue& items, const View& view, const ViewProjection& projection,
                      const DrawList& list, const DrawCache& table);
  bool is_hidden(const Drawable& d, const ViewProjection& projection, const DrawList& list, const WorldBox& box) const;
  bool can_cpu_select(const Drawable& d, const View& view) const;
  void add_to_strip(const Drawable& d, std::uint32_t number, const ViewProjection& projection, const DrawList& list,
                    const WorldBox& box);
  void draw_strip(const RenderQueue& items, const View& view, const ViewProjection& projection, const DrawList& list);
  void draw_seen_clusters(const Drawable& d, const View& view, const ViewProjection& projection, const DrawList& list,
                          const WorldBox& box, std::size_t first_run);
  void draw_seen_triangles(const Drawable& d, const View& view, const ViewProjection& projection, const DrawList& list,
                           const WorldBox& box);
  bool can_select_points(const Drawable& d) const;
  void draw_selected_points(const Drawable& d, const View& view, const ViewProjection& projection, const DrawList& list,
                            const WorldBox& box);
  void draw_selected_triangles(const Drawable& d, const PipelineKey& key, const ViewProjection& projection,
                               const DrawList& list);
  static PipelineKey key_in_view(const Drawable& d, const View& view, const DrawList& list);
  DrawRun& add_run(const Drawable& d, const PipelineKey& key, const MeshRange& range, std::uint32_t instance);
  std::uint32_t add_instance(const Drawable& d, const ViewProjection& projection, const DrawList& list);
  void take_places(const View& view, const ViewProjection& projection, const DrawList& list);
  std::size_t find_place(std::uint32_t item) const;
  const glm::dmat4& place_of(const Drawable& d, const DrawList& list) const;
  const WorldBox& box_of(std::uint32_t item, const DrawCache& table) const;
  WorldBox box_of(const Drawable& d, std::size_t tile, const DrawList& list, const DrawCache& table) const;
  void append_visible(const RenderQueue& items, const View& view);
  void add_items(const RenderQueue& items, const View& view, const ViewProjection& projection, const DrawList& list,
                 const DrawCache& table);
  PixelRect layered_pixels(const RenderQueue& items, const View& view, const ViewProjection& projection,
                           const DrawCache& table) const;
  void add_depth_visible(std::size_t first_layer, std::size_t end_layer);

  /// The group of a run that no other instance may join.
  static constexpr std::uint32_t kNoGroup = std::numeric_limits<std::uint32_t>::max();

  RasterTraits raster_;
  ViewDraws draws_;
  std::vector<DrawRun> runs_;
  std::vector<shader::Instance> instances_;
  std::vector<std::uint32_t> items_;
  std::vector<shader::LightBlock> lights_;
  std::vector<std::uint32_t> indices_;
  std::vector<shader::CpuSelectedVertex> cpu_selected_;
  std::vector<std::uint32_t> selected_points_;  // of one mesh
  std::vector<glm::vec3> point_positions_;
  std::vector<PackedAttributes> point_attributes_;
  std::uint64_t items_culled_ = 0;
  ColumnOcclusionBuffer* strip_ = nullptr;  // set in update() if the view is a strip
  FacingTolerance limit_;                   // of the view
  OcclusionCuller hidden_;                  // used if the view is not a strip
  TriangleSelector selector_;               // used if selecting_
  PointSelector point_selector_;            // used if selecting_points_
  bool selecting_ = false;                  // in the present view
  bool selecting_points_ = false;           // in the present view
  bool names_items_ = false;                // in the present pass
  std::span<const ItemPlace> places_;       // of the view
  std::vector<WorldBox> place_boxes_;       // of places_
  std::vector<std::uint32_t> seen_items_;   // used if the view is culled
  std::vector<std::uint32_t> positions_;    // of the drawables, in ascending order
  std::uint64_t views_ = 0;                 // calls of update()
  std::vector<ChosenLevel> chosen_;         // by tile of all items, used if the view has a dial
  std::vector<LackingLevel> lacking_;
  /// A round shape in the queue, at its level.
  struct RoundItem {
    RoundLevel level;
    std::uint32_t position = 0;
  };
  std::vector<RoundItem> round_;  // neighbours in the queue that may share draws
  /// The positions of the vertices of a round shape that a strip draws, by its place in the queue, ascending.
  struct StripRound {
    std::uint32_t position = 0;
    std::span<const glm::vec3> vertices{};
  };
  std::vector<StripRound> strip_round_;
  std::vector<MeshRange> seen_;
  std::vector<const Cluster*> seen_clusters_;
  std::uint32_t last_group_ = 0;
};

}  // namespace simvis
