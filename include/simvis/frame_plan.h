// Which views are rendered this frame, into which targets, and why. Plain data between the sensors and the renderer.
#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

namespace simvis {

/// A pinhole camera in pixels: a point (x, y, z) of the view frame is seen at pixel
/// (cx + fx x / z, cy + fy y / z), where pixel (0, 0) has its centre at (0.5, 0.5).
struct Pinhole {
  double fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;

  bool operator==(const Pinhole&) const = default;
};

/// Square pixels; the optical axis goes through the middle of the image. `hfov_rad` is in (0, pi), from edge to edge.
Pinhole centred_pinhole(std::uint32_t width_px, std::uint32_t height_px, double hfov_rad);

/// A pipeline that a view or a pass binds: shaders and fixed functions made for one kind of work.
struct PlannedPipeline {
  std::string variant;  ///< what it is made for
  std::string reason;   ///< what calls for it
  std::uint64_t draws = 0, triangles = 0;
  bool shades = false;  ///< it has a fragment shader
  bool made = false;    ///< in this frame

  bool operator==(const PlannedPipeline&) const = default;
};

/// A shadow map that the lights of a view are held against: views of the plan's pass of shadow maps.
struct ShadowUse {
  std::uint32_t light = 0;       ///< in DrawList::lights
  std::uint32_t first_view = 0;  ///< in that pass
  /// 1; or 6, the sides of a cube, 3 x 2 squares side by side. Where (x, y, z) is the first one's frame, theirs are
  /// (x, y, z), (x, -y, -z), (y, z, x), (y, -z, -x), (z, x, y), (z, -x, -y): each pair one above the other.
  std::uint32_t views = 1;
};

/// One virtual camera drawn into a rectangle of its pass.
///
/// Frames   view frame: x right, y down, z forward (optical frame). `view_from_world` is rigid.
/// Depth    reversed, infinite far plane: d = near_m / z, 0 where nothing is hit.
struct View {
  std::string name;    ///< for --explain, debug labels and messages
  std::string reason;  ///< why it is rendered
  Pinhole pinhole;
  double near_m = 0.05;
  glm::dmat4 view_from_world{1.0};
  std::uint32_t x_px = 0, y_px = 0, width_px = 0, height_px = 0;  ///< rectangle in the pass's targets
  bool sees_back_faces = false;  ///< of single-sided materials too: a laser meets matter from either side
  bool sees_lines_and_points = true;
  /// Rays are parallel to z instead of meeting in the eye: (x, y, z) is seen at pixel (cx + fx x, cy + fy y), fx and
  /// fy in pixels per metre, with depth d = (far_m - z) / (far_m - near_m). near_m may have either sign.
  bool orthographic = false;
  double far_m = 0;
  /// Of a strip of depth alone, the columns whose pixels are read, ascending: others may lack surfaces. Null: all.
  std::shared_ptr<const std::vector<std::uint32_t>> columns{};
  bool culled = true;  ///< false: what cannot be seen is drawn all the same; not a pixel that is read changes
  std::vector<ShadowUse> shadows{};          ///< of views of colour: where light may be in something's way
  std::vector<PlannedPipeline> pipelines{};  ///< in the order of drawing; see Renderer::complete

  bool shades() const { return std::ranges::any_of(pipelines, &PlannedPipeline::shades); }
};

/// Views that share one set of targets and one render pass.
///
/// Samples  the colour of a pixel is the mean, in linear light, of `grid` x `grid` samples at the centres of as many
///          equal squares that the pixel is cut into; each of these is in turn the mean of `msaa` samples of its
///          square at the device's standard places, which see edges but are shaded once. Depth is that of pixel
///          centres: a pass with more than one sample has none.
struct Pass {
  std::string name;
  std::uint32_t width_px = 0, height_px = 0;
  bool color = false;               ///< lit colour is wanted; false: no colour target exists and no light is evaluated
  bool depth = false;               ///< depth is read back
  std::vector<View> views{};        ///< rectangles do not overlap; in pixels, not samples
  std::uint32_t supersampling = 1;  ///< 1, 2 or 4
  std::uint32_t msaa = 1;           ///< one of the device's TargetLimits::msaa
  std::vector<PlannedPipeline> pipelines{};  ///< of the whole: the mean of its samples; see Renderer::complete
  /// Shadow maps: neither colour nor depth is read back; the depth stays on the device, where the views of other
  /// passes read it as View::shadows says. One pass of a plan at most; drawn before the others, wherever it stands.
  bool shadow_maps = false;

  std::uint32_t samples() const { return supersampling * supersampling * msaa; }  ///< of each pixel
};

/// Rays that a sensor casts after the passes are there.
struct RayCast {
  std::string name;
  std::string reason;
  std::uint64_t max_rays = 0;  ///< how many it casts at the most: which, it may learn from the passes
  std::string engine{};        ///< who casts them: see RayCaster. Known to who runs the plan
};

/// An effect that a due sensor shows this frame.
struct PlannedEffect {
  std::string sensor;
  std::string effect;  ///< its name in the catalogue
  std::string reason;  ///< what in the scene calls for it
};

/// Whether a sensor measures in a frame, and why not.
enum class DueState : std::uint8_t {
  due,
  off,      ///< it is turned off
  waiting,  ///< for its rate
  hidden,   ///< it stands in a part that is switched off
};

/// A sensor of the scene, due or not.
struct PlannedSensor {
  std::string name, type;
  DueState due_state = DueState::due;
  double rate_hz = 0;                        ///< 0: every frame
  std::vector<std::string> outputs{};        ///< that are taken
  std::size_t first_pass = 0, end_pass = 0;  ///< its passes are these of the plan's
  std::size_t first_cast = 0, end_cast = 0;  ///< likewise
};

/// A buffer or an image on the device.
struct PlannedMemory {
  std::string name;
  std::string reason;
  std::uint64_t bytes = 0;     ///< that it takes there, the device's rounding included
  std::uint64_t uploaded = 0;  ///< bytes that this frame has written
};

/// What sensors ask for stands in passes, casts and effects; who runs the plan adds the rest. Nothing is drawn,
/// allocated, uploaded or compiled but what it names.
struct FramePlan {
  std::vector<Pass> passes;
  std::vector<RayCast> casts{};
  std::vector<PlannedEffect> effects{};
  std::vector<PlannedSensor> sensors{};
  std::vector<PlannedMemory> memory{};
};

/// A pass of a plan: its number, and that of its first view among all views.
struct DrawnPass {
  std::size_t pass = 0, first_view = 0;
};

/// The passes in the order in which they are drawn: shadow maps first, else as they stand.
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
