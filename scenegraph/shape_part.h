// Parts without a file: simple shapes, and empty frames.
#pragma once

#include <string>

#include <simvis/attributes.h>
#include <simvis/part_importer.h>
#include "scenegraph/shape_limits.h"

namespace simvis {

/// The rows of a part's attributes that describe a shape.
inline constexpr AttributeSpec kShapeRow{
    .name = "shape",
    .kind = AttributeKind::choice,
    .text = "the shape of a part without a file; without both, the part is an empty frame",
    .choices = "box sphere cylinder cone capsule plane heightmap wall",
};
inline constexpr AttributeSpec kSizeRow{
    .name = "size",
    .kind = AttributeKind::text,
    .unit = "m",
    .text = "of a box: x y z; of a plane or a heightmap: x y",
};
inline constexpr AttributeSpec kRadiusRow{
    .name = "radius",
    .unit = "m",
    .text = "of a sphere, cylinder, cone or capsule",
    .min = kMinShapeLength_m,
    .max = kMaxShapeLength_m,
};
inline constexpr AttributeSpec kLengthRow{
    .name = "length",
    .unit = "m",
    .text = "along z, of a cylinder, a cone, or a capsule without its ends",
    .min = kMinShapeLength_m,
    .max = kMaxShapeLength_m,
};
inline constexpr AttributeSpec kColorRow{
    .name = "color",
    .kind = AttributeKind::vector,
    .text = "red green blue of a shape, linear; default: white",
    .min = 0,
    .max = 1,
};

inline constexpr AttributeSpec kTextureRow{
    .name = "texture",
    .kind = AttributeKind::file,
    .text = "file of a picture that covers each side of a shape, multiplied by its colour",
};
inline constexpr AttributeSpec kHeightsRow{
    .name = "heights",
    .kind = AttributeKind::file,
    .text = "of a heightmap: file of a picture, PNG or EXR; each pixel is a point of the surface",
};
inline constexpr AttributeSpec kZRangeRow{
    .name = "z_range",
    .kind = AttributeKind::text,
    .default_value = "0 1",
    .unit = "m",
    .text = "of a heightmap: heights of the value 0, which is black in a PNG, and of 1, which is white",
};
/// Throws InputError at the first attribute that does not go with the others: a shape besides a file, a size of a
/// sphere, a box without a size, a colour of an empty frame.
void check_shape_attributes(const Command& part, const AttributeValues& attributes);

/// A text that two checked commands without a file share only if they describe the same content.
std::string shape_key(const Command& part, const AttributeValues& attributes);

/// The content of a checked command without a file: the shape with its material, or an empty group. Throws InputError
/// at the attribute for a picture that is not there, or heights that cannot be read; a texture that cannot be decoded
/// is a warning.
PartContent make_shape(const Command& part, const AttributeValues& attributes, ContentPool& pool);

}  // namespace simvis
