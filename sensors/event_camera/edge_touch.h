// Whether an edge that moves comes into a pixel's square between two times, and when it is deepest in there.
//
// Frames   V = view frame of the camera: x right, y down, z forward.
// Depth    of an edge in the square: how far it has to be moved, in pixels, so that both touch no more. Below 0: it is
//          beside the square by at least so much.
// Method   Between two times the ends of the edge leave their chords by no more than acceleration * time^2 / 8, so the
//          edge stays in the hull of its four ends, grown by that. A line that parts this hull from the square shows
//          that the edge stays outside; otherwise the time is halved.
// Limit    A touch of less than kTouch_px is none. Edges with a part nearer than `near` are not looked at.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <optional>

#include <simvis/frame_plan.h>

namespace simvis {

inline constexpr double kTouch_px = 1e-4;

class EdgeTouch {
 public:
  using Ends = std::array<glm::dvec3, 2>;  ///< V

  /// The square is that of the pixel in `column` and `row` of an image of this pinhole.
  EdgeTouch(const Pinhole& pinhole, double near_m, std::uint32_t column, std::uint32_t row);

  /// Whether an edge comes no deeper than kTouch_px into the square between two times at which it has these ends.
  /// `sag_m` is by how much its ends may leave their chords in between.
  bool stays_out(const Ends& begin, const Ends& end, double sag_m) const;
  /// The time between two others at which an edge is deepest in the square, if it touches the square in between and at
  /// neither of the two. `ends` has the edge at a time, and `acceleration_m` is the largest one of its ends, in metres
  /// by the square of the unit of times.
  std::optional<double> deepest(const std::function<Ends(double)>& ends, double acceleration_m, double begin,
                                double end) const;

 private:
  struct Seen {
    glm::dvec2 a, b;
  };
  std::optional<Seen> seen(const Ends& ends) const;
  double depth_px(const Ends& ends) const;
  double sag_px(const Ends& begin, const Ends& end, double sag_m) const;

  Pinhole pinhole_;
  double near_m_;
  glm::dvec2 centre_px_;
};

}  // namespace simvis
