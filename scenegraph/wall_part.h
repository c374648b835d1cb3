// The attributes of a part of shape `wall`.
#pragma once

#include <simvis/attributes.h>
#include "scenegraph/shape_limits.h"
#include "scenegraph/wall_mesh.h"

namespace simvis {

/// The rows of a part's attributes that describe a wall.
inline constexpr AttributeSpec kPointsRow{
    .name = "points",
    .kind = AttributeKind::text,
    .unit = "m",
    .text = "of a wall: the line that it stands on, \"x y, x y, ...\"; closed if the last point is the first one",
};
inline constexpr AttributeSpec kHeightRow{
    .name = "height",
    .unit = "m",
    .text = "of a wall",
    .min = kMinShapeLength_m,
    .max = kMaxShapeLength_m,
};
inline constexpr AttributeSpec kThicknessRow{
    .name = "thickness",
    .unit = "m",
    .text = "of a wall",
    .min = kMinShapeLength_m,
    .max = kMaxShapeLength_m,
};
inline constexpr AttributeSpec kDoorsRow{
    .name = "doors",
    .kind = AttributeKind::text,
    .unit = "m",
    .text = "in a wall: \"at width height, ...\"; at: the middle, along the line",
};
inline constexpr AttributeSpec kWindowsRow{
    .name = "windows",
    .kind = AttributeKind::text,
    .unit = "m",
    .text = "in a wall: \"at width sill height, ...\"; sill: height of the lower edge",
};

/// The checked plan of a wall. Throws InputError at the attribute.
WallPlan wall_plan(const AttributeValues& attributes);

}  // namespace simvis
