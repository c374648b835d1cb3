#include "program/datasets/formats.h"

#include <algorithm>
#include <iterator>
#include <vector>

#include <simvis/error.h>
#include <simvis/location.h>
#include "program/datasets/bop.h"
#include "program/datasets/coco.h"
#include "program/datasets/dsec.h"
#include "program/datasets/euroc.h"
#include "program/datasets/kitti.h"
#include "program/datasets/nuscenes.h"
#include "program/datasets/tum.h"

namespace simvis {
namespace {

struct NamedFormat {
  std::string_view name;
  std::unique_ptr<DatasetFormat> (*make)(double depth_unit_m);
};

constexpr NamedFormat kFormats[] = {
    {"bop",
     [](double depth_unit_m) -> std::unique_ptr<DatasetFormat> { return std::make_unique<BopFormat>(depth_unit_m); }},
    {"coco", [](double) -> std::unique_ptr<DatasetFormat> { return std::make_unique<CocoFormat>(); }},
    {"dsec", [](double) -> std::unique_ptr<DatasetFormat> { return std::make_unique<DsecFormat>(); }},
    {"euroc", [](double) -> std::unique_ptr<DatasetFormat> { return std::make_unique<EurocFormat>(); }},
    {"kitti", [](double) -> std::unique_ptr<DatasetFormat> { return std::make_unique<KittiFormat>(false); }},
    {"nuscenes", [](double) -> std::unique_ptr<DatasetFormat> { return std::make_unique<NuscenesFormat>(); }},
    {"semantickitti", [](double) -> std::unique_ptr<DatasetFormat> { return std::make_unique<KittiFormat>(true); }},
    {"tum", [](double) -> std::unique_ptr<DatasetFormat> { return std::make_unique<TumFormat>(); }},
};

}  // namespace

std::string dataset_names(std::string_view separator) {
  std::string names;
  for (const NamedFormat& each : kFormats)
    names += (names.empty() ? "" : std::string(separator)) + std::string(each.name);
  return names;
}

std::unique_ptr<DatasetFormat> make_dataset_format(std::string_view name, double depth_unit_m) {
  const auto found = std::ranges::find(kFormats, name, &NamedFormat::name);
  if (found != std::end(kFormats)) return found->make(depth_unit_m);
  std::vector<std::string_view> known;
  for (const NamedFormat& each : kFormats) known.push_back(each.name);
  throw InputError("--dataset: there is no format " + in_quotes(name) + suggestion(name, known) +
                   " (expected one of: " + dataset_names(", ") + ")");
}

}  // namespace simvis
