// Content of a part that is nothing but shapes, which are read later.
#pragma once

#include <functional>

#include <simvis/part_importer.h>

namespace simvis {

/// Content with one empty group, which PartContent::read_shapes fills with the root that `read` returns. `read` returns
/// the whole content: its root, whose name is dropped, and its warnings. It may be called again after it has thrown.
PartContent postponed_shapes(std::function<PartContent(ContentPool& pool)> read);

}  // namespace simvis
