#include "elements/dynamics/forces/wind.h"

#include <cmath>
#include <memory>

#include <simvis/node.h>

namespace simvis {
namespace {

constexpr double kMaxWind_m_s = 1e3;
// Knots within the time in which gusts forget their value by 1/e, and the knots that a gust remembers: what is older
// counts less than e^-16.
constexpr int kKnotsPerTime = 8, kRemembered = 16 * kKnotsPerTime;

const ElementRegistration kWindRegistration({
    .name = "wind",
    .summary = "Air that moves with gusts, for elements drag that name it.",
    .notes = "The same everywhere in the world. Gusts are a process of Ornstein and Uhlenbeck. At the knots, 8 within "
             "gust_time, they are normally distributed with the deviation gust, and correlated over a time t by exp(-t "
             "/ gust_time). Between them the velocity changes evenly, so that the deviation is up to 3 % smaller. A "
             "gust depends on the seed of the run, the name and the time of physics only.",
    .attributes = rows_of<WindDesc>().table(),
    .create = create_element<WindElement>,
});

}  // namespace

AttributeRows<WindDesc> WindDesc::rows() {
  using Desc = WindDesc;
  constexpr AttributeLimits kVelocity{.min = -kMaxWind_m_s, .max = kMaxWind_m_s};
  return {row(&Desc::gust_time_s, "gust_time", "s", {.min = 0.001, .max = 1e6}, "time after which gusts are others"),
          row(&Desc::x_m_s, "x", "m/s", kVelocity, "mean velocity along x of the world").live(),
          row(&Desc::y_m_s, "y", "m/s", kVelocity, "along y").live(),
          row(&Desc::z_m_s, "z", "m/s", kVelocity, "along z").live(),
          row(&Desc::gust_m_s, "gust", "m/s", {.min = 0, .max = kMaxWind_m_s},
              "standard deviation of each component of the velocity")
              .live()};
}

WindElement::WindElement(const ElementContext& context)
    : name_(context.command.require("name").value),
      random_(context.seed, "wind/" + name_),
      desc_(rows_of<WindDesc>().read(context.attributes)) {
  const auto mark = std::make_shared<Group>();
  mark->name = name_;
  context.scene.insert(context.command, mark);
}

// A sum over the noise of this and earlier knots, not a recursion, so that each knot has the same bytes whatever came
// before.
glm::dvec3 WindElement::gust_at(std::uint64_t knot) const {
  const double kept = std::exp(-1.0 / kKnotsPerTime), fresh = std::sqrt(1 - kept * kept);
  glm::dvec3 sum(0);
  double weight = fresh;
  for (int age = 0; age < kRemembered; ++age, weight *= kept) {
    const std::uint64_t frame = knot + kRemembered - static_cast<std::uint64_t>(age);  // 1 and later
    for (glm::length_t axis = 0; axis < 3; ++axis) {
      sum[axis] += weight * random_.gaussian(frame, static_cast<std::uint32_t>(axis), 0);
    }
  }
  return sum;
}

glm::dvec3 WindElement::velocity_m_s(double time_s) const {
  const glm::dvec3 mean(desc_.x_m_s, desc_.y_m_s, desc_.z_m_s);
  if (desc_.gust_m_s == 0) return mean;
  const double place = time_s / desc_.gust_time_s * kKnotsPerTime, floor = std::floor(place);
  const auto first = static_cast<std::uint64_t>(floor);
  if (!knots_ || knots_->first != first) {
    const bool is_next = knots_ && knots_->first + 1 == first;
    knots_ = Knots{first, is_next ? knots_->after : gust_at(first), gust_at(first + 1)};
  }
  return mean + desc_.gust_m_s * glm::mix(knots_->before, knots_->after, place - floor);
}

}  // namespace simvis
