// The effect `auto_exposure`: a camera that sets its exposure by its last image.
//
//   <sensor type="camera" ... auto_exposure="0.18" auto_exposure_time="0.2"/>
//
// Control  An image is scaled by the exposure E that the images before it have led to; the first one by 1. Its mean M
// of
//          min(1, E Y), with the luminance Y before scaling, is compared with the target `auto_exposure`, and after the
//          time t the next image has E (target / M)^(1 - e^(-t / T)), within the limits, with the time constant T. In a
//          scene that does not change and saturates nowhere log E therefore approaches its end as e^(-t / T). An image
//          that is black throughout leads to the largest exposure.
// State    the exposure depends on all images before, so that none can be left out; the two cameras of a stereo pair
// set
//          theirs independently.
#pragma once

#include <cstdint>

#include <simvis/camera_effect.h>
#include <simvis/state_archive.h>
#include "scenegraph/language/attribute_rows.h"

namespace simvis {

struct ExposureControl {
  double target = 0;                ///< mean luminance; 0: the exposure is fixed
  double time_constant_s = 0;       ///< 0: the next image has the exposure that this one asks for
  double least = 1e-3, most = 1e3;  ///< limits of the exposure

  /// The exposure after an image of this mean was taken with `exposure`, a time later.
  double next(double exposure, double mean, double later_s) const;

  static AttributeRows<ExposureControl> rows();
};

class AutoExposure : public CameraEffect, public Stateful {
 public:
  explicit AutoExposure(const ExposureControl& control) : control_(control) {}

  void post_process(const FrameTime& time, const CameraLayout&, Image& color) const override;
  bool remembers() const override { return true; }
  void archive(StateArchive& state) override {
    state(before_, last_);
    state.require(before_.time_ns < last_.time_ns || before_.time_ns < 0);
  }

 private:
  struct Metered {
    std::int64_t time_ns = -1;  // -1: there was no image
    double exposure = 1, mean = 0;
    void archive(StateArchive& state) {
      state(time_ns);
      if (time_ns != -1) state.require_past(time_ns);
      state.finite(exposure, mean);
    }
  };
  ExposureControl control_;
  mutable Metered before_, last_;  // an image whose time is not after the last one repeats it
};

}  // namespace simvis
