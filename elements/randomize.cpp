#include "elements/randomize.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string_view>

#include <simvis/philox.h>

namespace simvis {
namespace {

constexpr AttributeSpec kRandomizeAttributes[] = {
    {.name = "element", .kind = AttributeKind::element, .text = "required: the element whose parameter is drawn"},
    {.name = "param", .kind = AttributeKind::text, .text = "required: the parameter, as --list names it"},
    {.name = "distribution",
     .kind = AttributeKind::choice,
     .default_value = "uniform",
     .text = "uniform: from min to max; normal: mean and deviation, drawn again where the parameter does not allow the "
             "value; choice: one of values, each with the same probability",
     .choices = "uniform normal choice"},
    {.name = "min", .text = "smallest value, uniform only; in the parameter's unit, as all of these"},
    {.name = "max", .text = "largest value, uniform only"},
    {.name = "mean", .text = "mean, normal only"},
    {.name = "deviation", .text = "standard deviation, normal only", .min = 0, .open_min = true},
    {.name = "values", .kind = AttributeKind::text, .text = "numbers separated by spaces, choice only"},
};

// Of the attributes of distributions, those that each one takes.
struct Taken {
  std::string_view distribution;
  std::vector<std::string_view> attributes;
};
const std::vector<Taken>& taken_attributes() {
  static const std::vector<Taken> taken{
      {"uniform", {"min", "max"}}, {"normal", {"mean", "deviation"}}, {"choice", {"values"}}};
  return taken;
}

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
    .attributes = kRandomizeAttributes,
    .create = create_element<RandomizeElement>,
});

void check_taken(const ElementContext& context) {
  const std::string chosen(context.attributes.choice("distribution"));
  for (const Taken& taken : taken_attributes()) {
    for (const std::string_view name : taken.attributes) {
      const bool is_taken = taken.distribution == chosen, is_set = context.attributes.is_set(name);
      if (is_taken && !is_set) {
        fail_at(context.command.where, "distribution \"" + chosen + "\" needs the attribute " + in_quotes(name));
      }
      if (!is_taken && is_set) {
        fail_at(context.attributes.where(name), "attribute " + in_quotes(name) +
                                                    " is not allowed with distribution=\"" + chosen +
                                                    "\", expected it with \"" + std::string(taken.distribution) + "\"");
      }
    }
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

RandomizeElement::RandomizeElement(const ElementContext& context) {
  const AttributeValues& attributes = context.attributes;
  element_ = context.command.require("element").value;
  parameter_ = context.command.require("param").value;
  parameter_at_ = attributes.where("param");
  check_taken(context);
  const std::string_view distribution = attributes.choice("distribution");
  if (distribution == "uniform") {
    low_ = attributes.number("min");
    high_ = attributes.number("max");
    values_at_ = attributes.where("max");
    if (!(low_ <= high_)) fail_at(values_at_, "attribute \"max\" is below \"min\", expected at least as much");
    return;
  }
  if (distribution == "normal") {
    distribution_ = Distribution::normal;
    mean_ = attributes.number("mean");
    deviation_ = attributes.number("deviation");
    values_at_ = attributes.where("mean");
    return;
  }
  distribution_ = Distribution::choice;
  values_at_ = attributes.where("values");
  values_ = read_values(attributes.text("values"), values_at_);
}

void RandomizeElement::bind(std::size_t index, const AttributeSpec& limits, std::uint64_t seed) {
  index_ = index;
  seed_ = seed;
  std::vector<double> ends = values_;
  if (distribution_ == Distribution::uniform) ends = {low_, high_};
  if (distribution_ == Distribution::normal) {
    ends = {mean_};
    low_ = limits.min;
    high_ = limits.max;
    if (high_ - low_ < kMinWidth_deviations * deviation_) {
      fail_at(values_at_,
              "the parameter " + in_quotes(element_ + "." + parameter_) +
                  " has limits that are closer than a tenth of the deviation, expected a smaller deviation");
    }
  }
  for (const double value : ends) {
    const std::string wrong = check_number(limits, value);
    if (!wrong.empty()) fail_at(values_at_, element_ + "." + parameter_ + ": " + wrong);
  }
}

double RandomizeElement::normal(std::uint64_t frame) const {
  const SensorRandom random(seed_, "randomize/" + element_ + "." + parameter_);
  for (std::uint32_t draw = 0; draw < kMaxDraws; ++draw) {
    const double value = mean_ + deviation_ * random.gaussian(frame, 0, draw);
    if (value > low_ && value < high_) return value;
  }
  return mean_;
}

double RandomizeElement::value(std::uint64_t frame) const {
  if (distribution_ == Distribution::normal) return normal(frame);
  const double share = SensorRandom(seed_, "randomize/" + element_ + "." + parameter_).uniform(frame, 0, 0);
  if (distribution_ == Distribution::uniform) return std::min(low_ + share * (high_ - low_), high_);
  return values_[std::min(static_cast<std::size_t>(share * static_cast<double>(values_.size())), values_.size() - 1)];
}

}  // namespace simvis
