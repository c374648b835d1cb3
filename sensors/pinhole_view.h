// What sensors with pinhole cameras share: their attributes, their geometry, and their pictures out of a pass.
#pragma once

#include "engine/frame_plan.h"
#include "engine/renderer.h"
#include "scenegraph/attributes.h"
#include "sensors/image.h"

namespace simvis {

inline constexpr AttributeSpec kWidthAttribute{.name = "width",
                                               .kind = AttributeKind::integer,
                                               .default_value = "640",
                                               .unit = "px",
                                               .text = "columns of the image",
                                               .min = 1,
                                               .max = 16384};
inline constexpr AttributeSpec kHeightAttribute{.name = "height",
                                                .kind = AttributeKind::integer,
                                                .default_value = "480",
                                                .unit = "px",
                                                .text = "rows of the image",
                                                .min = 1,
                                                .max = 16384};
inline constexpr AttributeSpec kHfovAttribute{
    .name = "hfov",
    .default_value = "60",
    .unit = "deg",
    .text = "horizontal field of view, from the left edge of the image to the right",
    .min = 0,
    .max = 180,
    .open_min = true,
    .open_max = true};
inline constexpr AttributeSpec kNearAttribute{.name = "near",
                                              .default_value = "0.05",
                                              .unit = "m",
                                              .text = "what is nearer along the optical axis is not seen",
                                              .min = 0,
                                              .open_min = true};

/// Square pixels; the optical axis goes through the middle of the image. `hfov_rad` is in (0, pi), from edge to edge.
Pinhole centred_pinhole(std::uint32_t width_px, std::uint32_t height_px, double hfov_rad);

/// The picture of one view of a pass: linear RGBA.
void take_color(const Pass& pass, const View& view, const PassResult& result, Image& image);

/// The same for depth: metres along the optical axis, +infinity where nothing is hit.
void take_depth(const Pass& pass, const View& view, const PassResult& result, Image& image);

}  // namespace simvis
