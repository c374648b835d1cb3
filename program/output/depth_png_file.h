// Encodes depth and counts as 16-bit grey PNGs.
#pragma once

#include <string>

#include <simvis/image.h>
#include <simvis/measurement.h>

namespace simvis {

/// The code of a depth: round(depth / unit). 0 means that there is no depth: nothing is hit, or the code would not fit
/// in 16 bits. `unit_m` > 0: the length of one code.
std::uint16_t depth_code(float depth_m, double unit_m);

/// A grey PNG of 16 bits with these codes. `depth` has one channel. Throws MachineError if memory runs out.
std::string encode_depth_png(const Image& depth, double unit_m);

/// The same of an image of counts. A count above 65535 is 65535.
std::string encode_counts_png(const MeasuredArray& counts);

}  // namespace simvis
