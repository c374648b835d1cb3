#include "exchange/messages/transforms.h"

#include <cmath>

#include "exchange/messages/from_pose.h"

namespace simvis::ros {

namespace {

bool is_same(const glm::dmat4& a, const glm::dmat4& b) {
  for (int column = 0; column < 4; ++column) {
    const double tolerance = column == 3 ? Transforms::kFixed_m : Transforms::kFixed;
    for (int row = 0; row < 3; ++row) {
      if (!(std::abs(a[column][row] - b[column][row]) <= tolerance)) return false;
    }
  }
  return true;
}

}  // namespace

void Transforms::begin(std::int64_t time_ns) {
  time_ns_ = time_ns;
  moving_.transforms.clear();
}

void Transforms::set(const std::string& parent, const std::string& child, const glm::dmat4& parent_from_child,
                     bool can_move) {
  const TransformStamped message{header_of(time_ns_, parent), child, to_transform(parent_from_child)};
  const auto [found, is_new] = fixed_.try_emplace(child, Fixed{message, parent_from_child, can_move});
  Fixed& known = found->second;
  const bool starts_to_move = !known.moves && (can_move || known.message.header.frame_id != parent ||
                                               !is_same(known.parent_from_child, parent_from_child));
  known.moves = known.moves || starts_to_move;
  changed_ = changed_ || (is_new && !known.moves) || starts_to_move;
  if (known.moves) moving_.transforms.push_back(message);
}

std::optional<TFMessage> Transforms::new_fixed() {
  if (!changed_) return std::nullopt;
  changed_ = false;
  TFMessage all;
  for (const auto& [child, known] : fixed_) {
    if (!known.moves) all.transforms.push_back(known.message);
  }
  return all;
}

}  // namespace simvis::ros
