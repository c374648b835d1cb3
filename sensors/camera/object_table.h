// The table of the objects that a camera sees or would see: boxes, pixel counts, visible fraction, box in space,
// distances. One row for each object that has a class and at least one pixel of the picture if it stood alone.
//
// Order    by instance id.
// Boxes    x to the right, y down, in pixels from the picture's corner: a box runs from the left edge of its first
// column
//          to the right edge of its last one, so that its width is a number of columns. `visible` are the pixels that
//          show the object, `picture` those of its silhouette in the picture, `full` those of the canvas (PixelCanvas).
// Space    The box of SceneObject: where the object stands at the time of the frame.
// Planes   An object with a plane without end has no row.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/draw_list.h>
#include <simvis/measurement.h>
#include <simvis/output_spec.h>
#include <simvis/sensor_needs.h>
#include "sensors/camera/object_silhouettes.h"
#include "sensors/camera/pixel_truth.h"

namespace simvis {

/// The names of the outputs of a camera that has the word `boxes`; with `views`, those of a camera of two views.
std::vector<OutputSpec> object_outputs(const AttributeValues& attributes, bool views);

/// The output `silhouettes` of a view; `prefix` stands in front of its name.
OutputSpec silhouettes_output(const std::string& prefix, const AttributeValues& attributes);

/// The rays of silhouettes, for the plan of a frame. `what` is "camera NAME"; `pixels` is the number of its pixels.
RayCast silhouette_cast(const std::string& what, const std::string& sensor, std::uint64_t pixels);

/// The name of the output `silhouettes`: numbers of 0 and 1 per pixel, one channel for each row of the table;
/// one channel of zeros if it has no rows.
inline constexpr const char* kSilhouettes = "silhouettes";

/// One picture, and what its pixels show.
struct SeenPicture {
  IdentifiedList world;
  const PixelItems& pixels;
  std::span<const PixelRows> rows;    ///< from the top
  glm::dmat4 world_from_camera{1.0};  ///< V at the time of the frame
  unsigned threads = 1;               ///< that cast silhouettes; the same for all pictures of a camera
};

/// The table of one camera.
class ObjectTable {
 public:
  /// `views` is how many pictures a measurement has.
  explicit ObjectTable(const TruthDesc& desc, std::size_t views) : desc_(desc), pictures_(views) {}

  /// Starts a new table.
  void begin();
  /// Adds the rows of a picture. `silhouettes` are those of its camera.
  void add(const SeenPicture& picture, std::size_t view, ObjectSilhouettes& silhouettes);
  /// Ends the table. `names` are those of the views, in their order.
  void add_to(Measurement& measurement, std::span<const char* const> names) const;

 private:
  struct Picture {
    std::uint32_t width_px = 0, height_px = 0, objects = 0;
    SharedArray<std::uint8_t> masks;  // [(y * width + x) * objects + object]
  };

  TruthDesc desc_;
  bool measured_ = false;
  std::vector<Picture> pictures_;  // by view; with silhouettes only
  SharedArray<double> values_;     // row by row
};

}  // namespace simvis
