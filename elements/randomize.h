// The element `randomize`: draws a parameter of another element anew in each frame.
//
//   <randomize element="MOVE" param="x" distribution="uniform" min="-1" max="1"/>
//
// which is short for an element of this type with a name of its own.
//
// Numbers  A value is drawn for the seed of the run, the number of the frame, the element and the parameter, by a
//          counter-based generator: the order of frames and commands, other elements, shards and processes change
//          nothing.
// Order    It is set before elements move in a frame, and replaces what was set before.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <simvis/element.h>
#include <simvis/location.h>

namespace simvis {

enum class Distribution : std::uint8_t { uniform, normal, choice };

/// What a command `randomize` says. Each distribution has some of the numbers, in the parameter's unit.
struct RandomizeDesc {
  std::string element, parameter;
  Distribution distribution = Distribution::uniform;
  double low = 0, high = 0;
  double mean = 0, deviation = 0;
  std::string values;  ///< separated by spaces
};

class RandomizeElement : public Element {
 public:
  explicit RandomizeElement(const ElementContext& context);
  void update(ParameterView /*values*/) override {}
  bool moves_itself() const override { return true; }

  const std::string& element() const { return desc_.element; }
  const std::string& parameter() const { return desc_.parameter; }
  const Location& parameter_at() const { return parameter_at_; }

  /// Called once, with the index of the parameter, its limits and the seed. Throws InputError at the attribute if a
  /// value that may be drawn is outside the limits.
  void bind(std::size_t index, const AttributeSpec& limits, std::uint64_t seed);
  /// Index of the parameter in Parameters::values(). After bind().
  std::size_t index() const { return index_; }
  /// What is drawn for the frame. After bind().
  double value(std::uint64_t frame) const;

 private:
  double normal(std::uint64_t frame) const;

  RandomizeDesc desc_;
  double least_ = 0, most_ = 0;  // the limits of the parameter
  Location parameter_at_, values_at_;
  std::vector<double> values_;  // of a choice
  std::size_t index_ = 0;
  std::uint64_t seed_ = 0;
};

}  // namespace simvis
