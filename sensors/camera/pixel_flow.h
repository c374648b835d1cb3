// Optical flow of a camera: where the points that its pixels show are in the other image, whether they are seen there,
// and how far they have moved.
//
// Backward  from the pixels of this image to the camera's previous one, in which it was due. Nothing but poses is kept
//           of that image, so it may have been skipped.
// Forward   from the pixels of the previous image to this one: it is known one measurement later than the image whose
//           pixels it has, because nothing says earlier where objects will be.
// Pixels    The flow of a pixel is that of the point at its centre: see point_flow.h. Pixels of the sky and of what is
//           hidden in the other image have flow too.
// Occlusion A point is seen in the other image if it lies within it, where rows are when they are taken, and the ray of
//           the other image to the point meets the same item there and nothing before it, to within the rounding of
//           both ranges. A point of the sky is seen if its ray meets nothing.
// Drawn     Of a drawn image the points follow from its depths and items; those on meshes that change their shape are
//           cast. For forward flow they are kept until the next image. Images with occlusion are cast.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/frame_plan.h>
#include <simvis/frame_results.h>
#include <simvis/measurement.h>
#include "sensors/camera/camera_moment.h"
#include "sensors/camera/camera_views.h"
#include "sensors/camera/moved_world.h"
#include "sensors/camera/pixel_rays.h"
#include "sensors/camera/point_flow.h"

namespace simvis {

/// What is asked for: words of the attribute `outputs`.
struct FlowDesc {
  bool backward = false, forward = false;  ///< pixels, x right, y down
  bool scene = false;      ///< metres since the previous image: view frame at the time of the row; NaN: the sky
  bool occlusion = false;  ///< of `backward` and `forward`: 1 where a point is not seen in the other image
  Location outputs_at{};   ///< where the attribute stands, for messages

  bool any() const { return backward || forward || scene; }
  /// Whether the image must be cast.
  bool casts() const { return occlusion; }
};

/// Reads the attribute `outputs`. Throws InputError if occlusion is asked for without a flow.
FlowDesc flow_desc(const AttributeValues& attributes);

/// The outputs of one view; `prefix` stands in front of their names.
std::vector<OutputSpec> flow_outputs(const std::string& prefix, const AttributeValues& attributes);

/// The flow of one view.
class PixelFlow {
 public:
  /// `layout` and `views` must live as long as this object. Throws InputError if an effect does not say where its lens
  /// shows a direction.
  PixelFlow(const FlowDesc& desc, const CameraLayout& layout, const CameraViews& views, double near_m);

  /// Starts an image.
  void begin(CameraMoment now);
  /// The image is skipped. If it is made after all, as HistoryDependence::last_measurement says, it has no forward
  /// flow.
  void skip(CameraMoment now) {
    skipped_ns_ = now.time_ns;
    history_.add(std::move(now));
  }
  /// As that of Stateful. Of cast images the surfaces are no part of it: they are cast again. `beside` is the flow of
  /// another eye of the same camera, which the state has before, with its scenes; null: there is none.
  void archive(StateArchive& state, const PixelFlow* beside);
  /// Adds the rays of this image, beyond those through the centres of its pixels. `name` is that of the sensor.
  void plan(const std::string& name, bool drawn, FramePlan& plan) const;

  /// Reads the pixels of drawn rows. The pass has items.
  void read(const Pass& pass, const View& view, const PassResult& result, std::size_t rows);
  /// The pixels of a drawn image that are left open, ascending: those on meshes that change their shape.
  const std::vector<std::uint32_t>& left_open() const { return left_open_; }
  /// Sets pixels of a drawn image that were cast after all. `pixels` belong to these rows; directions and `seen` by
  /// pixel.
  void set(std::span<const std::uint32_t> pixels, std::size_t rows, std::span<const glm::dvec3> directions,
           std::span<const SeenSurface> seen);
  /// Completes an image that was drawn, after the last set(). If the previous image was not drawn, its pixels are cast
  /// on so many threads.
  void complete_drawn(unsigned threads);
  /// Completes an image that was cast: `seen` by pixel, which is taken over in exchange for others. `caster`'s world is
  /// `list`, that of this image; `rays` are those of the camera.
  void cast(RayCaster& caster, const DrawList& list, PixelRays& rays, std::vector<SeenSurface>& seen);

  /// The images, in the order of flow_outputs(), without numbers before the first begin().
  void add_to(Measurement& measurement, const std::string& prefix, const std::string& view) const;

 private:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::min();
  // The flow of all pixels of one image to another, and what is asked of it.
  struct Direction {
    PointFlow points;
    const CameraMoment &from, &to;
    SharedArray<float>* flow;
    SharedArray<std::uint8_t>* occlusion;  // null: not asked for
    SharedArray<float>* scene;             // the same
  };
  // A ray of the other image to a point.
  struct Sight {
    std::uint32_t pixel = 0, item = kNoItem;
    glm::dvec3 direction{0};
    double behind_m = 0, range_m = 0, error_bound_m = 0;
  };
  // The numbers of a direction's images, to be written; null: not asked for.
  struct Written {
    float *flow = nullptr, *scene = nullptr;
  };
  struct FlowPixel {
    std::size_t number = 0;  // in the image
    glm::dvec2 centre{0};
  };
  // The points of a drawn image: by pixel.
  struct DrawnPoints {
    std::int64_t time_ns = kNever;
    std::vector<double> depth_m;      // [y * width + x], along Z; read only if there is an item
    std::vector<std::uint32_t> item;  // the same; kNoItem: the sky
  };
  static Written written(const Direction& direction);
  FollowedPoint follow(Direction& direction, const Written& images, std::size_t rows, std::size_t pixel,
                       const glm::dvec3& ray, const SeenSurface& surface);
  static void set(Direction& direction, const Written& images, const FlowPixel& pixel, const ImagePoint& point,
                  const std::optional<glm::dvec2>& place);
  void require_rows(const StateArchive& state, const CameraMoment& moment) const;
  const CameraMoment* compared(const StateArchive& state, std::int64_t time_ns) const;
  void archive(StateArchive& state, DrawnPoints& drawn) const;
  void start_drawn();
  void keep_drawn(std::size_t pixel, const ImagePoint& point) {
    drawn_.item[pixel] = point.item;
    drawn_.depth_m[pixel] = point.point.z;
  }
  bool lacks_drawn() const;
  bool lacks_cast() const;
  void cast_left_open(unsigned threads);
  void follow_all(Direction& direction, std::span<const glm::dvec3> directions, std::span<const SeenSurface> seen);
  std::optional<Sight> sight_of(const FollowedPoint& followed, std::size_t pixel) const;
  void look_back(Direction& direction, unsigned threads);
  void look_ahead(Direction& direction, RayCaster& caster, const DrawList& list);
  void look(Direction& direction, std::size_t rows, RayCaster& caster, const DrawList& world);
  void cast_before(const CameraMoment& before, PixelRays& rays, unsigned threads);

  FlowDesc desc_;
  const CameraLayout& layout_;
  const CameraViews& views_;
  double near_m_;
  MomentHistory history_;
  std::optional<Direction> backward_;     // of the image under way, if it has a previous one
  std::optional<Direction> forward_;      // to the image under way, if it has a previous one
  DrawnPoints drawn_, drawn_before_;      // with forward flow: of the last two drawn images
  std::optional<PixelRays> own_rays_;     // for pixels of the previous image that are left open
  std::int64_t skipped_ns_ = kNever;      // the last image that was skipped
  std::vector<std::uint32_t> left_open_;  // pixels of a drawn image on meshes that change their shape
  MovedWorld before_world_, now_world_;
  std::vector<SeenSurface> seen_, seen_before_;  // of the last two cast images
  std::int64_t seen_ns_ = kNever, seen_before_ns_ = kNever;
  std::vector<std::vector<Sight>> sights_;  // by rows of the other image
  SurfaceRays sight_rays_;
  std::vector<glm::dvec3> sight_directions_;
  std::vector<double> sight_behind_m_;
  std::vector<SeenSurface> met_;  // by sight of some rows
  SharedArray<float> flow_backward_, flow_forward_, scene_flow_;
  SharedArray<std::uint8_t> occlusion_backward_, occlusion_forward_;
};

}  // namespace simvis
