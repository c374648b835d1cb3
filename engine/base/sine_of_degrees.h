// Sine and cosine of angles in degrees.
#pragma once

namespace simvis {

struct SineCosine {
  double sin, cos;
};

/// Of a finite angle. Angles of any size are reduced exactly; multiples of 90 degrees give exactly 0, 1 or -1.
SineCosine sine_of_degrees(double angle_deg);

}  // namespace simvis
