// The formats of datasets by name.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "program/datasets/dataset_format.h"

namespace simvis {

/// The names, "bop coco ...", and what each is, for --help.
std::string dataset_names(std::string_view separator);

/// `depth_unit_m` is the length of one code of depth, for formats that leave it open. Throws InputError for a name that
/// does not exist.
std::unique_ptr<DatasetFormat> make_dataset_format(std::string_view name, double depth_unit_m);

}  // namespace simvis
