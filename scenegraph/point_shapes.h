// The attributes `point_radius` and `point_shape` of parts of files: points become solid.
#pragma once

#include <filesystem>
#include <optional>

#include <simvis/attributes.h>
#include <simvis/command.h>
#include <simvis/exact_surface.h>
#include <simvis/part_importer.h>
#include "scenegraph/shape_limits.h"

namespace simvis {

inline constexpr AttributeSpec kPointRadiusRow{
    .name = "point_radius",
    .unit = "m",
    .text =
        "radius of the shapes that the points of a file are; without it, laser scanners do not meet points, and "
        "cameras draw them as single pixels",
    .min = kMinShapeLength_m,
    .max = kMaxShapeLength_m,
};
inline constexpr AttributeSpec kPointShapeRow{
    .name = "point_shape",
    .kind = AttributeKind::choice,
    .default_value = "sphere",
    .text = "shape of points that have a radius; a disc is perpendicular to the normal that the file gives the point",
    .choices = "sphere disc",
};

/// The shape of the points of a part, in the unit of its file; nothing if they have no radius. Throws InputError at the
/// attribute `point_shape` of points without a radius.
std::optional<ExactSurface> shape_of_points(const Command& part, const AttributeValues& attributes, double scale);

/// Makes every mesh of points a solid cloud of these shapes. Points without a normal cannot be discs and are left out,
/// with a warning. `file` is named in warnings and errors. Throws InputError where no point has a normal for its disc.
void make_points_solid(PartContent& content, const std::filesystem::path& file, const ExactSurface& shape,
                       ContentPool& pool);

}  // namespace simvis
