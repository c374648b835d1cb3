// The attributes `scale` and `unit` of parts of files.
#pragma once

#include <simvis/attributes.h>
#include <simvis/part_importer.h>

namespace simvis {

inline constexpr AttributeSpec kScaleRow{
    .name = "scale",
    .text = "factor of all lengths of the file",
    .min = 1e-6,
    .max = 1e6,
};
inline constexpr AttributeSpec kUnitRow{
    .name = "unit",
    .kind = AttributeKind::choice,
    .text = "the unit of the file's lengths; default: metres",
    .choices = "mm cm m inch",
};

/// The factor from lengths of the file, as its importer returns them, to metres: scale times unit. Throws InputError if
/// the file says its own unit and the part says another one.
double part_scale(const Command& part, const AttributeValues& attributes);

/// Scales what the file shows. Throws InputError if the file carries commands or insertion points: what is inserted
/// there has lengths of its own in metres.
void scale_content(PartContent& content, double factor);

}  // namespace simvis
