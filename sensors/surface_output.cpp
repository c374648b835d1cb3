#include "sensors/surface_output.h"

#include <algorithm>
#include <deque>
#include <mutex>
#include <set>
#include <tuple>

#include "engine/base/assert.h"

namespace simvis {
namespace {

struct SurfaceOutputs {
  std::mutex mutex;
  std::deque<SurfaceOutputType> types;  // whose addresses stay
  std::set<std::string> choices;        // that attributes refer to
};

SurfaceOutputs& registered_surface_outputs() {
  static SurfaceOutputs all;
  return all;
}

}  // namespace

SurfaceOutputRegistration::SurfaceOutputRegistration(const SurfaceOutputType& type) {
  SIMVIS_ASSERT(type.fill != nullptr && type.channels >= 1 && type.channels <= kMaxSurfaceChannels);
  SurfaceOutputs& all = registered_surface_outputs();
  const std::lock_guard lock(all.mutex);
  SIMVIS_ASSERT(std::ranges::count(all.types, type.name, &SurfaceOutputType::name) == 0);
  all.types.push_back(type);
}

std::vector<const SurfaceOutputType*> surface_outputs() {
  SurfaceOutputs& all = registered_surface_outputs();
  const std::lock_guard lock(all.mutex);
  std::vector<const SurfaceOutputType*> types;
  for (const SurfaceOutputType& type : all.types) types.push_back(&type);
  std::ranges::sort(types, {}, [](const SurfaceOutputType* type) { return std::tuple(type->order, type->name); });
  return types;
}

std::string_view with_surface_outputs(std::string_view own_choices) {
  std::string choices(own_choices);
  for (const SurfaceOutputType* type : surface_outputs()) choices += ' ' + std::string(type->name);
  SurfaceOutputs& all = registered_surface_outputs();
  const std::lock_guard lock(all.mutex);
  return *all.choices.insert(std::move(choices)).first;
}

}  // namespace simvis
