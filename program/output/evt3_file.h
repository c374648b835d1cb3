// Events of an event camera as a RAW file of Prophesee's format EVT 3.0.
#pragma once

#include <string>

#include "program/output/table_frame.h"

namespace simvis {

/// Whether the table has the columns of events: t_us, x, y and polarity, in an image that the format can address.
bool has_events(const TableFrame& table);

/// A header with the size of the image, and the words of exchange/messages/evt3.h. The table has events (asserted).
std::string encode_evt3_file(const TableFrame& table);

}  // namespace simvis
