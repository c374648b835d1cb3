// What a microbolometer reads of the radiance on its pixels: it is slow, noisy and uneven.
//
// Lag      dS/dt = (L - S) / T with the time constant T. Between two measurements the radiance L of a pixel is taken to
//          change evenly, by m per second; then S = L1 - m T + (S0 - L0 + m T) e^(-dt / T), exactly. At the first
//          measurement S = L.
// Noise    Gaussian, independent for each pixel and measurement. Its standard deviation in radiance is netd_k times the
//          slope of the radiance of black bodies at kNetdTemperature_k, so that a black body of this temperature is
//          measured with the standard deviation netd_k, a warmer one with less, a colder one with more.
// Pattern  an offset of each pixel that stays for the run, drawn with a standard deviation that fixed_pattern_k
//          gives in the same way: what is left after the camera's own correction of it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <simvis/frame_time.h>
#include <simvis/philox.h>
#include <simvis/state_archive.h>
#include "scenegraph/language/attribute_rows.h"

namespace simvis {

/// Data sheets give the NETD for a black body of about room temperature.
inline constexpr double kNetdTemperature_k = 300;

struct BolometerDesc {
  double netd_k = 0, fixed_pattern_k = 0, time_constant_s = 0;  ///< each 0: none

  static AttributeRows<BolometerDesc> rows();
};

class Bolometer {
 public:
  Bolometer(const BolometerDesc& desc, std::uint64_t seed, const std::string& sensor, std::size_t pixels);

  /// Turns the radiances of the pixels at a time, in W / (m^2 sr), into those that are read, which may be below 0. A
  /// time that is not after the last one repeats that measurement.
  void read(const FrameTime& time, std::vector<double>& radiance);
  /// As that of Stateful.
  void archive(StateArchive& state);

 private:
  struct State {
    std::int64_t time_ns = 0;
    std::vector<double> radiance{}, signal{};  // by pixel; empty: nothing was measured yet
    void archive(StateArchive& state) { state(time_ns, radiance, signal); }
  };
  void lag(std::int64_t time_ns, std::vector<double>& radiance);

  BolometerDesc desc_;
  SensorRandom noise_;
  std::size_t pixels_;
  std::vector<double> pattern_;  // by pixel, in radiance; empty: there is none
  State before_, last_;          // of the measurement before the last one, and of the last one; only with a lag
};

}  // namespace simvis
