#include "elements/dynamics/model_part.h"

#include <algorithm>
#include <vector>

namespace simvis {
namespace {

// Returns the prefix that the scene gives to the names in the part's file.
std::string prefix_of(const ElementContext& context, const std::string& part, const PartContent& content) {
  if (content.points.empty()) return "";
  const ObjectTree& objects = context.scene.objects();
  const std::vector<std::string> points = objects.names_in(*objects.find(part));
  for (const std::string& point : points) {
    if (!point.ends_with(content.points.front())) continue;
    const std::string prefix = point.substr(0, point.size() - content.points.front().size());
    if (std::ranges::all_of(content.points,
                            [&](const std::string& own) { return std::ranges::count(points, prefix + own) > 0; })) {
      return prefix;
    }
  }
  return "";
}

}  // namespace

ModelPart find_model_part(const ElementContext& context, const CommandAttribute& part, const std::string& use) {
  const PartContent* content = nullptr;
  if (context.scene.has_part(part.value)) content = &context.scene.content_of(part.value);
  if (content == nullptr || content->model == nullptr) {
    fail_at(part.where, "attribute " + in_quotes(part.name) + ": " + in_quotes(part.value) + " is not allowed for " +
                            use + ", expected the name of a part from a URDF, SDF or MJCF file");
  }
  const Command& command = context.scene.part_command(part.value);
  for (const char* const name : {"scale", "unit"}) {
    if (const CommandAttribute* const scale = command.find(name)) {
      fail_at(scale->where, "attribute " + in_quotes(name) + " is not allowed on a part with a robot of physics");
    }
  }
  return {*content->model, prefix_of(context, part.value, *content)};
}

}  // namespace simvis
