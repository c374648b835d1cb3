// Attribute tables that are put together from several.
#pragma once

#include <vector>

#include <simvis/attributes.h>

namespace simvis {

/// The rows of a table, and of more that are appended to it. The result lives as long as the program.
AttributeTable join_tables(const std::vector<std::vector<AttributeSpec>>& tables);

}  // namespace simvis
