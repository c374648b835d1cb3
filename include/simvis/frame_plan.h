// The frame plan: the views that are rendered this frame, their targets, and the reason for each. Plain data between
// the sensors and the renderer.
#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

#include <simvis/export.h>

namespace simvis {

/// The limits of a device's render targets.
struct TargetLimits {
  std::uint32_t width_px = 0,       ///< largest width of a target
      height_px = 0;                ///< largest height of a target
  std::vector<std::uint32_t> msaa;  ///< supported numbers of colour samples per pixel, ascending: always 1, and those
                                    ///< of 2, 4 and 8 that the device has
};

/// A pinhole camera in pixels: a point (x, y, z) of the view frame is seen at pixel
/// (cx + fx x / z, cy + fy y / z), where pixel (0, 0) has its centre at (0.5, 0.5).
struct Pinhole {
  double fx_px = 0,  ///< focal length along x
      fy_px = 0,     ///< focal length along y
      cx_px = 0,     ///< principal point, x
      cy_px = 0;     ///< principal point, y

  bool operator==(const Pinhole&) const = default;  ///< member by member
};

/// A pinhole with square pixels whose optical axis passes through the centre of the image. `hfov_rad` is in (0, pi),
/// from edge to edge.
SIMVIS_API Pinhole centred_pinhole(std::uint32_t width_px, std::uint32_t height_px, double hfov_rad);

/// A pipeline that a view or a pass binds: shaders and fixed functions made for one kind of work.
struct PlannedPipeline {
  std::string variant;      ///< the kind of work
  std::string reason;       ///< what requires it
  std::uint64_t draws = 0,  ///< draw calls with it
      triangles = 0;        ///< triangles drawn with it
  bool shades = false;      ///< it has a fragment shader
  bool made = false;        ///< it was created in this frame

  bool operator==(const PlannedPipeline&) const = default;  ///< member by member
};

/// A shadow map that a view reads for one light. Its views belong to the plan's pass of shadow maps.
struct ShadowUse {
  std::uint32_t light = 0;       ///< in DrawList::lights
  std::uint32_t first_view = 0;  ///< in the pass of shadow maps
  /// 1; or 6, the sides of a cube, arranged as 3 x 2 squares. If (x, y, z) is the frame of the first side, the frames
  /// of the six sides are (x, y, z), (x, -y, -z), (y, z, x), (y, -z, -x), (z, x, y), (z, -x, -y): the two sides of each
  /// pair lie one above the other.
  std::uint32_t views = 1;
};

/// A coarser level at which a view draws meshes: see View::max_error_px.
struct DrawnLevel {
  std::uint32_t level = 0;  ///< 1 has about half the triangles of the mesh, 2 a quarter, and so on
  std::uint64_t items = 0,  ///< items, or tiles of large meshes, that are drawn at it
      exact_triangles = 0,  ///< of their meshes, before culling
      triangles = 0;        ///< of their level, before culling
  double error_px = 0;      ///< the largest bound on the error of one of these items

  bool operator==(const DrawnLevel&) const = default;  ///< member by member
};

/// An item where one view sees it, instead of where it is in the draw list.
struct ItemPlace {
  std::uint32_t item = 0;           ///< in DrawList::items
  glm::dmat4 world_from_mesh{1.0};  ///< differs from that of the list by a rigid motion
};

/// One virtual camera that is drawn into a rectangle of its pass.
///
/// Frames   view frame: x right, y down, z forward (optical frame). `view_from_world` is rigid.
/// Depth    reversed, infinite far plane: d = near_m / z, 0 where nothing is hit.
struct View {
  std::string name;                 ///< for --explain, debug labels and messages
  std::string reason;               ///< why it is rendered
  Pinhole pinhole;                  ///< in pixels of the rectangle
  double near_m = 0.05;             ///< nearest depth along Z that is drawn
  glm::dmat4 view_from_world{1.0};  ///< rigid
  std::uint32_t x_px = 0,           ///< left edge of the rectangle in the pass's targets
      y_px = 0,                     ///< top edge of the rectangle
      width_px = 0,                 ///< width of the rectangle
      height_px = 0;                ///< height of the rectangle
  bool sees_back_faces = false;     ///< back faces of single-sided materials too: a laser hits surfaces from both sides
  bool sees_lines_and_points = true;  ///< meshes of lines and of points are drawn
  /// Rays are parallel to z instead of starting at the eye: (x, y, z) is seen at pixel (cx + fx x, cy + fy y), where fx
  /// and fy are pixels per metre, with depth d = (far_m - z) / (far_m - near_m). near_m may have either sign.
  bool orthographic = false;
  double far_m = 0;  ///< farthest depth along Z of an orthographic view
  /// For a strip whose depth alone is read: the columns whose pixels are read, ascending. Other columns may lack
  /// surfaces. Null: all columns are read.
  std::shared_ptr<const std::vector<std::uint32_t>> columns{};
  std::vector<ItemPlace> places{};  ///< ascending by item; lights and shadows are those of the list
  /// Items of the list that the view does not draw, ascending; their shadows stay. Null: none.
  std::shared_ptr<const std::vector<std::uint32_t>> ignored{};
  bool culled = true;  ///< false: invisible geometry is drawn too; no pixel that is read changes
  /// Pixels by which surfaces may appear displaced: meshes are drawn at their coarsest level whose error stays below
  /// this. 0: every mesh is drawn as it is, and round shapes within 0.1 pixels. 0 for views without colour.
  double max_error_px = 0;
  std::vector<DrawnLevel> levels{};  ///< coarser levels that are drawn, finest first; set by Renderer::complete()
  std::vector<ShadowUse> shadows{};  ///< for views of colour: the shadow maps of their lights
  std::vector<PlannedPipeline> pipelines{};  ///< in drawing order; set by Renderer::complete()

  /// Whether one of the pipelines has a fragment shader.
  bool shades() const { return std::ranges::any_of(pipelines, &PlannedPipeline::shades); }
};

/// Views that share one set of targets and one render pass.
///
/// Samples  the colour of a pixel is the mean, in linear light, of `supersampling` x `supersampling` samples at the
///          centres of equal squares into which the pixel is divided. Each of these samples is the mean of `msaa`
///          samples of its square at the device's standard locations: these resolve edges but are shaded once. Depth is
///          that of pixel centres: a pass with more than one sample has no depth.
struct Pass {
  std::string name;                          ///< for --explain, debug labels and messages
  std::uint32_t width_px = 0,                ///< of the targets, in pixels
      height_px = 0;                         ///< of the targets, in pixels
  bool color = false;                        ///< lit colour is read back; false: no colour target and no lighting
  bool depth = false;                        ///< depth is read back
  bool items = false;                        ///< items are read back; only with depth and one sample of each pixel
  std::vector<View> views{};                 ///< rectangles do not overlap; in pixels, not samples
  std::uint32_t supersampling = 1;           ///< 1, 2 or 4
  std::uint32_t msaa = 1;                    ///< one of the device's TargetLimits::msaa
  std::vector<PlannedPipeline> pipelines{};  ///< of the whole pass: the mean of samples; set by Renderer::complete()
  /// A pass of shadow maps: neither colour nor depth is read back; the depth stays on the device, where the views of
  /// other passes read it according to View::shadows. A plan has at most one; it is drawn before the other passes,
  /// whatever its position.
  bool shadow_maps = false;

  std::uint32_t samples() const { return supersampling * supersampling * msaa; }  ///< samples per pixel
  /// Whether it has a target for items. With colour their numbers are in its alpha.
  bool has_item_target() const { return items && !color; }
};

/// Rays that a sensor casts after the passes are rendered.
struct RayCast {
  std::string name;    ///< for --explain
  std::string reason;  ///< why rays are cast
  /// The most rays that begin at the sensor and at bounces; which of them are cast may depend on the rendered passes. A
  /// ray that goes on behind a surface or a layer, or that is cast again because an item moves, counts once. Rays of
  /// boxes and silhouettes are those of one item.
  std::uint64_t max_rays = 0;
  std::string engine{};  ///< RayCaster::engine() of the caster; set by the code that runs the plan
  bool colors = false;   ///< what is made of the hits depends on the colours of surfaces, so their pictures are needed
};

/// An effect that a due sensor shows this frame.
struct PlannedEffect {
  std::string sensor;  ///< the sensor's name
  std::string effect;  ///< its name in the catalogue
  std::string reason;  ///< what in the scene makes it active
};

/// A buffer or an image on the device.
struct PlannedMemory {
  std::string name;            ///< for --explain
  std::string reason;          ///< what requires it
  std::uint64_t bytes = 0;     ///< device memory that it takes, the device's rounding included
  std::uint64_t uploaded = 0;  ///< bytes that this frame wrote into it
};

/// The work of one frame. Sensors add passes, casts and effects; the code that runs the plan adds the rest. Only work
/// that the plan names is drawn, allocated, uploaded or compiled.
struct FramePlan {
  std::vector<Pass> passes;              ///< see drawing_order()
  std::vector<RayCast> casts{};          ///< after the passes
  std::vector<PlannedEffect> effects{};  ///< shown by due sensors
  std::vector<PlannedMemory> memory{};   ///< all device memory
  unsigned threads = 0;                  ///< of sensors that compute in collect(), as SimulationDesc::threads
};

/// A pass of a plan in drawing order.
struct DrawnPass {
  std::size_t pass = 0,  ///< in FramePlan::passes
      first_view = 0;    ///< number of its first view among the views of all passes
};

/// The passes in the order in which they are drawn: shadow maps first, the others in the order of the plan.
inline std::vector<DrawnPass> drawing_order(const FramePlan& plan) {
  std::vector<DrawnPass> order;
  for (std::size_t pass = 0, view = 0; pass < plan.passes.size(); view += plan.passes[pass++].views.size()) {
    order.push_back({pass, view});
  }
  std::stable_partition(order.begin(), order.end(),
                        [&](const DrawnPass& drawn) { return plan.passes[drawn.pass].shadow_maps; });
  return order;
}

}  // namespace simvis
