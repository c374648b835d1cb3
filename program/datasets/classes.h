// The classes of a scene, in records and over all frames.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>

#include "program/datasets/dataset_format.h"

namespace simvis {

/// [[id, name], ...] by id.
Record classes_record(std::span<const SceneItem> items);

/// The classes of all records, each of which has classes_record() as "classes". Throws InputError if a class has two
/// names.
std::map<std::uint32_t, std::string> all_classes(std::span<const Record> records);

}  // namespace simvis
