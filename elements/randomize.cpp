#include "elements/randomize.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string_view>

#include <simvis/philox.h>
#include "scenegraph/language/attribute_rows.h"

namespace simvis {
namespace {

auto draws(Distribution distribution) {
  return [distribution](const RandomizeDesc& desc) { return desc.distribution == distribution; };
}

AttributeRows<RandomizeDesc> randomize_rows() {
  using Desc = RandomizeDesc;
  return {row(&Desc::element, AttributeKind::element, "element", "required: the element whose parameter is drawn"),
          row(&Desc::parameter, AttributeKind::text, "param", "required: the parameter, as --list names it"),
          row(&Desc::distribution, "distribution",
              {{Distribution::uniform, "uniform"}, {Distribution::normal, "normal"}, {Distribution::choice, "choice"}},
              "uniform: from min to max; normal: mean and deviation, drawn again where the parameter does not allow "
              "the value; choice: one of values, each with the same probability"),
          AttributeRows<Desc>{row(&Desc::low, "min", "", kAnyNumber,
                                  "smallest value, uniform only; in the parameter's unit, as all of these")
                                  .without_default(),
                              row(&Desc::high, "max", "", kAnyNumber, "largest value, uniform only").without_default()}
              .only("with distribution=\"uniform\"", draws(Distribution::uniform)),
          AttributeRows<Desc>{
              row(&Desc::mean, "mean", "", kAnyNumber, "mean, normal only").without_default(),
              row(&Desc::deviation, "deviation", "", kAboveZero, "standard deviation, normal only").without_default()}
              .only("with distribution=\"normal\"", draws(Distribution::normal)),
          row(&Desc::values, AttributeKind::text, "values", "numbers separated by spaces, choice only")
              .only("with distribution=\"choice\"", draws(Distribution::choice))};
}
const AttributeRows<RandomizeDesc> kRandomizeRows = randomize_rows();

// How often a normal number outside the limits is drawn again. The limits are at least a tenth of the deviation apart
// and the mean is within, so that a draw is within them with a probability of at least 0.039: all of these fail once in
// 10^17 frames, which then get the mean.
constexpr std::uint32_t kMaxDraws = 1000;
constexpr double kMinWidth_deviations = 0.1;

const ElementRegistration kRandomizeRegistration({
    .name = "randomize",
    .summary = "Draws a parameter of another element in each frame.",
    .notes = "The command <randomize element=\"...\" param=\"...\" .../> is short for an element of this type. The "
             "value depends on the seed, the number of the frame, the element and the parameter, and on nothing else. "
             "It replaces what --set, a trajectory or a program has set. randomized.csv has the drawn values.",
    .attributes = kRandomizeRows.table(),
    .create = create_element<RandomizeElement>,
});

// A distribution needs all of its numbers.
void check_complete(const ElementContext& context, const RandomizeDesc& desc) {
  for (const AttributeRow<RandomizeDesc>& row : kRandomizeRows.list()) {
    if (!row.allowed || !row.allowed(desc) || context.attributes.is_set(row.spec.name)) continue;
    fail_at(context.command.where, "distribution " + in_quotes(context.attributes.choice("distribution")) +
                                       " needs the attribute " + in_quotes(row.spec.name));
  }
}

std::vector<double> read_values(const std::string& text, const Location& where) {
  std::vector<double> values;
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = std::min(text.find(' ', start), text.size());
    const std::string word = text.substr(start, end - start);
    start = end + 1;
    if (word.empty()) continue;
    double value = 0;
    if (!parse_number(word, value)) {
      fail_at(where, "attribute \"values\": " + in_quotes(word) + " is not allowed, expected finite numbers");
    }
    values.push_back(value);
  }
  return values;
}

}  // namespace

RandomizeElement::RandomizeElement(const ElementContext& context)
    : desc_(kRandomizeRows.read(context.command, context.attributes)) {
  const AttributeValues& attributes = context.attributes;
  context.command.require("element");
  parameter_at_ = context.command.require("param").where;
  check_complete(context, desc_);
  switch (desc_.distribution) {
    case Distribution::uniform:
      values_at_ = attributes.where("max");
      if (!(desc_.low <= desc_.high))
        fail_at(values_at_, "attribute \"max\" is below \"min\", expected at least as much");
      break;
    case Distribution::normal:
      values_at_ = attributes.where("mean");
      break;
    case Distribution::choice:
      values_at_ = attributes.where("values");
      values_ = read_values(desc_.values, values_at_);
      break;
  }
}

void RandomizeElement::bind(std::size_t index, const AttributeSpec& limits, std::uint64_t seed) {
  index_ = index;
  seed_ = seed;
  std::vector<double> ends = values_;
  if (desc_.distribution == Distribution::uniform) ends = {desc_.low, desc_.high};
  if (desc_.distribution == Distribution::normal) {
    ends = {desc_.mean};
    least_ = limits.min;
    most_ = limits.max;
    if (most_ - least_ < kMinWidth_deviations * desc_.deviation) {
      fail_at(values_at_,
              "the parameter " + in_quotes(desc_.element + "." + desc_.parameter) +
                  " has limits that are closer than a tenth of the deviation, expected a smaller deviation");
    }
  }
  for (const double value : ends) {
    const std::string wrong = check_number(limits, value);
    if (!wrong.empty()) fail_at(values_at_, desc_.element + "." + desc_.parameter + ": " + wrong);
  }
}

double RandomizeElement::normal(std::uint64_t frame) const {
  const SensorRandom random(seed_, "randomize/" + desc_.element + "." + desc_.parameter);
  for (std::uint32_t draw = 0; draw < kMaxDraws; ++draw) {
    const double value = desc_.mean + desc_.deviation * random.gaussian(frame, 0, draw);
    if (value > least_ && value < most_) return value;
  }
  return desc_.mean;
}

double RandomizeElement::value(std::uint64_t frame) const {
  if (desc_.distribution == Distribution::normal) return normal(frame);
  const double share = SensorRandom(seed_, "randomize/" + desc_.element + "." + desc_.parameter).uniform(frame, 0, 0);
  if (desc_.distribution == Distribution::uniform)
    return std::min(desc_.low + share * (desc_.high - desc_.low), desc_.high);
  return values_[std::min(static_cast<std::size_t>(share * static_cast<double>(values_.size())), values_.size() - 1)];
}

}  // namespace simvis
