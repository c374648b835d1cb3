// A whole file as one tree of links.
#pragma once

#include "import/model/model_description.h"

namespace simvis {

/// All bodies of a file as one tree: the only body, or several behind a link without mass that stands for the file's
/// frame. Throws InputError with the place: the file is a world, or two bodies are not joined.
ModelTree single_tree(const ModelDescription& description);

}  // namespace simvis
