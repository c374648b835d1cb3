// Parts without a file: simple shapes, and empty frames.
#pragma once

#include <string>

#include <simvis/attributes.h>
#include <simvis/part_importer.h>

namespace simvis {

/// The rows of a part's attributes that describe a shape.
inline constexpr AttributeSpec kShapeRow{
    .name = "shape",
    .kind = AttributeKind::choice,
    .text = "the shape of a part without a file; without both, the part is an empty frame",
    .choices = "box sphere cylinder cone capsule plane",
};
inline constexpr AttributeSpec kSizeRow{
    .name = "size",
    .kind = AttributeKind::text,
    .unit = "m",
    .text = "of a box: x y z; of a plane: x y",
};
inline constexpr AttributeSpec kRadiusRow{
    .name = "radius",
    .unit = "m",
    .text = "of a sphere, cylinder, cone or capsule",
    .min = 1e-6,
    .max = 1e6,
};
inline constexpr AttributeSpec kLengthRow{
    .name = "length",
    .unit = "m",
    .text = "along z, of a cylinder, a cone, or a capsule without its ends",
    .min = 1e-6,
    .max = 1e6,
};
inline constexpr AttributeSpec kColorRow{
    .name = "color",
    .kind = AttributeKind::vector,
    .text = "red green blue of a shape, linear; default: white",
    .min = 0,
    .max = 1,
};

/// Throws InputError at the first attribute that does not go with the others: a shape besides a file, a size of a
/// sphere, a box without a size, a colour of an empty frame.
void check_shape_attributes(const Command& part, const AttributeValues& attributes);

/// A text that two checked commands without a file share only if they describe the same content.
std::string shape_key(const AttributeValues& attributes);

/// The content of a checked command without a file: the shape with its material, or an empty group.
PartContent make_shape(const AttributeValues& attributes, ContentPool& pool);

}  // namespace simvis
