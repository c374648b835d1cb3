// Samples of DDS that are CDR bytes already: an opaque type of Cyclone DDS without fields.
#pragma once

#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>

#include <cstddef>
#include <string>
#include <string_view>

namespace simvis::ros {

/// A type without a key, for dds_create_topic_sertype(), which takes it over. Samples from the network that are longer
/// than `max_bytes` are not received.
ddsi_sertype* make_raw_type(const std::string& name, std::size_t max_bytes);

/// A sample with a copy of these bytes, encapsulation included, for dds_writecdr(), which takes it over.
ddsi_serdata* make_raw_sample(const ddsi_sertype& type, std::string_view bytes);

/// The bytes of a sample of a raw type. They may end with up to 3 bytes of padding. Valid as long as the sample.
std::string_view bytes_of(const ddsi_serdata& sample);

}  // namespace simvis::ros
