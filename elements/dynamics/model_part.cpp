#include "elements/dynamics/model_part.h"

#include <algorithm>
#include <vector>

namespace simvis {
namespace {

bool has_ending(const PartContent& content, std::span<const std::string_view> endings) {
  return std::ranges::find(endings, content.file.extension().string()) != endings.end();
}

// Returns the prefix that the scene gives to the names in the part's file.
std::string prefix_of(const ElementContext& context, const std::string& part, const PartContent& content) {
  if (content.points.empty()) return "";
  const std::vector<std::string> points = context.scene.points_of_part(part);
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

ModelPart read_model_part(const ElementContext& context, const CommandAttribute& part, bool takes_urdf) {
  const PartContent* content = nullptr;
  if (context.scene.has_part(part.value)) content = &context.scene.own_part(part.value, part.where).content;
  const bool is_sdf = content != nullptr && has_ending(*content, kSdfEndings);
  if (!is_sdf && !(takes_urdf && content != nullptr && has_ending(*content, kUrdfEndings))) {
    fail_at(part.where, "attribute " + in_quotes(part.name) + ": " + in_quotes(part.value) + " is not allowed for " +
                            (takes_urdf ? "a robot, expected the name of a part from a URDF or SDF file"
                                        : "the models of a world, expected the name of a part from an SDF file"));
  }
  const Command& command = context.scene.part_command(part.value);
  for (const char* const name : {"scale", "unit"}) {
    if (const CommandAttribute* const scale = command.find(name)) {
      fail_at(scale->where, "attribute " + in_quotes(name) + " is not allowed on a part with a robot of physics");
    }
  }
  const CommandAttribute* const arguments = command.find("xacro_arguments");
  return {.request = {.file = content->file,
                      .xacro_arguments = arguments == nullptr ? std::string() : arguments->value,
                      .packages = context.scene.packages()},
          .prefix = prefix_of(context, part.value, *content),
          .is_sdf = is_sdf};
}

}  // namespace simvis
