#include "scenegraph/part_scale.h"

#include <algorithm>

#include "engine/base/assert.h"

namespace simvis {
namespace {

struct LengthUnit {
  std::string_view name;
  double metres;
};
constexpr LengthUnit kLengthUnits[] = {{"mm", 0.001}, {"cm", 0.01}, {"m", 1}, {"inch", 0.0254}};

bool is_collada(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::ranges::transform(ending, ending.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
  return ending == ".dae" || ending == ".zae";
}

}  // namespace

double part_scale(const Command& part, const AttributeValues& attributes) {
  const double scale = attributes.is_set(kScaleRow.name) ? attributes.number(kScaleRow.name) : 1;
  if (!attributes.is_set(kUnitRow.name)) return scale;
  if (is_collada(part.require("file").value)) {
    fail_at(attributes.where(kUnitRow.name),
            "attribute \"unit\": a COLLADA file says its unit itself, expected \"scale\" for a factor besides it");
  }
  const auto unit = std::ranges::find(kLengthUnits, attributes.choice(kUnitRow.name), &LengthUnit::name);
  SIMVIS_ASSERT(unit != std::end(kLengthUnits));
  return scale * unit->metres;
}

void scale_content(PartContent& content, double factor) {
  if (!content.commands.empty() || !content.points.empty()) {
    throw InputError(content.file.string() +
                     ": the file carries commands or insertion points, whose lengths are metres, expected no \"scale\" "
                     "and no \"unit\"");
  }
  const auto scaled = std::make_shared<Separator>();
  glm::dmat4 matrix(factor);
  matrix[3][3] = 1;
  scaled->add(std::make_shared<Transform>(matrix));
  scaled->add(content.root);
  content.root = scaled;
}

}  // namespace simvis
