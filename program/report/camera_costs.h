// The costs of a camera: what each value of max_error_px costs in time, and what it changes in the picture.
//
// Costs are those of scanner_costs.h: frames in which only that camera measures, its variants in turns. What a value
// changes is taken from pictures of the same frames with colour and depth, without the effects of the camera, and with
// one sample for each pixel: those of the variant beside those of value 0, in which every triangle is drawn.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "program/report/picture_difference.h"
#include "program/report/scanner_costs.h"

namespace simvis {

/// The values of max_error_px whose costs are measured, in addition to that of the scene. The first one is exact.
inline constexpr double kCostedErrors_px[] = {0, 0.25, 0.5, 1, 2, 4, 16};

/// The bounds on displaced surfaces for which the list gives advice, in pixels.
inline constexpr double kCostTolerances_px[] = {0, 0.5, 1, 2};

/// One row of the list.
struct CameraVariantCosts {
  double max_error_px = 0;
  bool in_scene = false;                                ///< the value that the scene has
  double median_ms = 0;                                 ///< median time of a frame
  double first_quartile_ms = 0, third_quartile_ms = 0;  ///< a quarter of the frames took less, or more
  double processor_ms = 0;                              ///< median processor time of a frame, of all threads
  double ratio = 0;                                     ///< median_ms divided by that of the camera's cheapest variant
  std::uint64_t triangles = 0;                          ///< drawn in the last frame, over all views
  std::uint64_t coarse_items = 0;  ///< of the last frame: items, or tiles, that were drawn at a coarser level
  double bound_px = 0;             ///< the largest bound on the error of a drawn level, in all frames
  PictureDifference change;        ///< from the exact picture: the largest of all frames
};

struct CameraCosts {
  std::string camera;
  std::uint64_t frames = 0;
  double load = 0;                           ///< see CostRun::load()
  std::vector<CameraVariantCosts> variants;  ///< ascending by max_error_px
};

/// The names of the enabled sensors that draw colour pictures for the simulation and have the attribute max_error_px.
std::vector<std::string> costed_cameras(const Simulation& simulation);

/// Measures the costs of these cameras of a simulation and consumes the simulation. `desc.variants` is for scanners
/// alone. Throws InputError if one is mounted in a part that is switched off.
std::vector<CameraCosts> camera_costs(Simulation simulation, const CostDesc& desc = {});

/// The index of the recommended variant for a tolerance: of those that displace no surface by more, the most exact one
/// that is not surely dearer than the cheapest. That is so if the quartiles of their times are apart.
std::size_t cheapest_for(const CameraCosts& costs, double tolerance_px);

/// An aligned table with one line for each variant, in which the recommended variants are marked, and a line of advice
/// with the attribute to write in the scene.
std::string to_table(const CameraCosts& costs);

/// An explanation of its columns.
std::string camera_cost_legend();

/// A line of column names, then one line for each variant.
std::string to_csv(std::span<const CameraCosts> all_costs);

}  // namespace simvis
