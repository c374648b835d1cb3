// A picture of a few frames of a dataset, for people: one row for each view of a frame, with its colour, its depth, its
// labels, and its boxes drawn on the colour.
//
// Depth    from light, the nearest of the picture, to dark, the farthest, by the logarithm of depth. Black: none.
// Labels   a colour for each instance with a class; dark grey: without a class; black: nothing.
// Boxes    of the visible pixels in the colour of the instance; where nothing is visible, the full box as a dotted
//          line.
#pragma once

#include <cstdint>
#include <string>

#include "program/datasets/dataset_format.h"

namespace simvis {

inline constexpr std::uint32_t kSheetTile_px = 320;  ///< width of one picture of a sheet
inline constexpr std::uint64_t kSheetFrames = 6;     ///< most frames of a sheet

/// Whether a frame of so many is on the sheet.
bool is_on_sheet(std::uint64_t frame, std::uint64_t frames);

/// The rows of one frame: RGB, 8 bits, 4 * kSheetTile_px pixels wide. Empty if the frame has no view with colour.
std::string sheet_rows(const DatasetFrame& frame);

/// Whether a text is whole rows.
bool is_sheet(const std::string& rows);

/// A PNG of rows of RGB below each other. There is at least one row.
std::string sheet_png(const std::string& rows);

}  // namespace simvis
