#include "scenegraph/wall_part.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>

namespace simvis {
namespace {

[[noreturn]] void refuse_text(const AttributeValues& attributes, std::string_view name, std::string_view seen,
                              const std::string& expected) {
  fail_at(attributes.where(name),
          "attribute " + in_quotes(name) + ": " + in_quotes(seen) + " is not allowed, expected " + expected);
}

// The entries of a list whose entries are separated by commas, `size` numbers each.
template <std::size_t size>
std::vector<std::array<double, size>> read_list(const AttributeValues& attributes, std::string_view name,
                                                const std::string& expected) {
  std::vector<std::array<double, size>> list;
  std::string_view rest = attributes.text(name);
  for (bool more = true; more;) {
    const std::size_t comma = std::min(rest.find(','), rest.size());
    const std::string_view entry = rest.substr(0, comma);
    std::array<double, size> numbers{};
    bool valid = parse_numbers(entry, numbers);
    for (const double number : numbers) valid = valid && std::abs(number) <= kMaxShapeLength_m;
    if (!valid) {
      refuse_text(attributes, name, entry,
                  expected + " (m, at most " + format_number(kMaxShapeLength_m) + " either way), separated by commas");
    }
    list.push_back(numbers);
    more = comma < rest.size();
    rest.remove_prefix(std::min(comma + 1, rest.size()));
  }
  return list;
}

void require_size(const AttributeValues& attributes, std::string_view name, const char* what, double size_m) {
  if (size_m >= kMinShapeLength_m) return;
  refuse_text(attributes, name, format_number(size_m),
              "a " + std::string(what) + " of at least " + format_number(kMinShapeLength_m) + " m");
}

}  // namespace

WallPlan wall_plan(const AttributeValues& attributes) {
  WallPlan plan;
  plan.height_m = attributes.number(kHeightRow.name);
  plan.thickness_m = attributes.number(kThicknessRow.name);
  for (const auto& [x, y] : read_list<2>(attributes, kPointsRow.name, "points x y")) plan.points.emplace_back(x, y);
  if (plan.points.size() < 2) {
    refuse_text(attributes, kPointsRow.name, attributes.text(kPointsRow.name), "at least two points x y");
  }
  std::vector<std::string_view> written_in;  // by opening
  const auto add = [&](std::string_view name, const WallOpening& opening) {
    require_size(attributes, name, "width", opening.width_m);
    require_size(attributes, name, "height", opening.height_m);
    plan.openings.push_back(opening);
    written_in.push_back(name);
  };
  if (attributes.is_set(kDoorsRow.name)) {
    for (const auto& [at, width, height] : read_list<3>(attributes, kDoorsRow.name, "doors \"at width height\"")) {
      add(kDoorsRow.name, {.at_m = at, .width_m = width, .sill_m = 0, .height_m = height});
    }
  }
  if (attributes.is_set(kWindowsRow.name)) {
    for (const auto& [at, width, sill, height] :
         read_list<4>(attributes, kWindowsRow.name, "windows \"at width sill height\"")) {
      require_size(attributes, kWindowsRow.name, "sill", sill);
      add(kWindowsRow.name, {.at_m = at, .width_m = width, .sill_m = sill, .height_m = height});
    }
  }
  const std::optional<WallError> error = check_wall(plan);
  if (!error) return plan;
  if (error->of == WallError::Of::points) {
    fail_at(attributes.where(kPointsRow.name), "attribute \"points\": " + error->what);
  }
  const std::string_view name = written_in[error->index];
  fail_at(attributes.where(name), "attribute " + in_quotes(name) + ": the opening at " +
                                      format_number(plan.openings[error->index].at_m) + " m: " + error->what);
}

}  // namespace simvis
