// The outputs that cameras share. They are given as the attribute `outputs` says.
#pragma once

#include <cstdint>
#include <string>

#include <simvis/attributes.h>
#include <simvis/output_spec.h>

namespace simvis {

/// The shape of an image with the `width` and `height` of the attributes. `channels` 0: their number varies.
OutputShape image_shape(const AttributeValues& attributes, std::uint32_t channels);

/// `width` and `height` of the attributes are those of the image.
OutputSpec color_output(std::string name, const AttributeValues& attributes);
OutputSpec depth_output(std::string name, const AttributeValues& attributes);
OutputSpec disparity_output(const AttributeValues& attributes);
/// The bound of the errors of all depths.
OutputSpec depth_bound_output(const AttributeValues& attributes);

}  // namespace simvis
