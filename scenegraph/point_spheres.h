// The attribute `point_radius` of parts of files: points become solid.
#pragma once

#include <simvis/attributes.h>
#include <simvis/part_importer.h>
#include "scenegraph/shape_limits.h"

namespace simvis {

inline constexpr AttributeSpec kPointRadiusRow{
    .name = "point_radius",
    .unit = "m",
    .text =
        "radius of the spheres that the points of a file are; without it, laser scanners and physics do not meet "
        "points, and cameras draw them as single pixels",
    .min = kMinShapeLength_m,
    .max = kMaxShapeLength_m,
};

/// Makes every mesh of points a solid cloud of spheres of this radius, in the unit of the file. Returns whether there
/// is any.
bool make_points_solid(PartContent& content, double radius, ContentPool& pool);

}  // namespace simvis
