// The costs of light: what a camera's drawn picture and its paths of light cost in time, and how far each is from the
// light that the scene gives.
//
// Drawn      The scene's lamps without shadows, each as one light; with shadows; with their sizes; and with ambient
//            light and skies as distant lights that things block. Lights that a scene has no use for have no row.
// Paths      light="path" with 1, 4, 16 and 64 samples, of the scene as it is.
// Moment     Frames are a nanosecond apart, so that all pictures show one moment of what moves by itself. Only values
//            that elements of type randomize draw differ from frame to frame.
// Compared   All take the picture of the camera's lens, without its other effects. Large images are reduced, see
//            listed_camera(): the paths of the list are 118 for each pixel.
// Error      The root mean square over pixels and linear R, G and B of the difference from the converged picture, the
//            expected value of paths with the camera's number of bounces. It is estimated from independent pictures by
//            paths: the product of the differences from two of them has the square of the wanted difference as its
//            mean, whatever their noise is. Its uncertainty is the standard error over these pictures (jackknife).
// Time       Drawn pictures: as in camera_costs.h. Paths: one frame of each, after a frame that made the trees of rays.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <simvis/command.h>
#include <simvis/image.h>
#include <simvis/simulation.h>
#include "program/report/cost_desc.h"

namespace simvis {

/// The numbers of samples of paths whose costs are measured.
inline constexpr std::uint32_t kCostedSamples[] = {1, 4, 16, 64};

/// An error and its standard error.
struct LightError {
  double rms = 0, uncertainty = 0;  ///< linear radiance
};

/// Of a picture from the expected value of these, which are independent and have its size. At least two.
LightError light_error(const Image& picture, std::span<const Image> references);

/// One row of the list.
struct LightVariantCosts {
  std::string light;         ///< "drawn", "and msaa 4", "paths 16" of 16 samples
  std::uint64_t frames = 0;  ///< that were timed
  double median_ms = 0;      ///< median time of a frame
  double first_quartile_ms = 0, third_quartile_ms = 0;
  double processor_ms = 0;  ///< median processor time of a frame, of all threads
  LightError error{};       ///< in the first frame
};

struct LightCosts {
  std::string camera;
  double load = 0;                            ///< see CostRun::load()
  std::uint64_t width_px = 0, height_px = 0;  ///< of the pictures
  double mean_radiance = 0;                   ///< of the converged picture
  std::uint64_t bounces = 0;                  ///< of its paths
  std::string refused{};  ///< why paths do not see the scene; empty: they do. Then there are no variants.
  std::vector<LightVariantCosts> variants{};
};

/// The most pixels of the pictures that are compared, but for the rounding of their sides.
inline constexpr std::int64_t kListedPixels = 120 * 68;

/// The command of a camera with the same view in an image of that many pixels: width, height, focal lengths, principal
/// point and polynomials of pixels are scaled. An image that has no more stays as it is. The height is rounded, so that
/// the view is up to half a pixel higher or lower.
Command listed_camera(Command command);

/// The names of the enabled sensors that show colour for the simulation and can take it by paths of light.
std::vector<std::string> costed_lights(const Simulation& simulation);

/// Measures these costs and consumes the simulation. Errors as camera_costs().
std::vector<LightCosts> light_costs(Simulation simulation, const CostDesc& desc = {});

/// An aligned table with one line for each variant.
std::string to_table(const LightCosts& costs);

/// An explanation of its columns.
std::string light_cost_legend();

/// A line of column names, then one line for each variant.
std::string to_csv(std::span<const LightCosts> all_costs);

}  // namespace simvis
