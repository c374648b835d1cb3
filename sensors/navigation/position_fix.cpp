#include "sensors/navigation/position_fix.h"

namespace simvis {
namespace {

// Bounds the rounding of the determinant of a covariance matrix, as a share of its trace^3. The determinant has six
// products of three entries, each of which is at most (trace / 3)^3 and rounds five times: 30 / 27 in u = 2^-53.
constexpr double kDeterminantError = 2 * 0x1p-53;

}  // namespace

std::optional<PositionFix> fix_position(std::span<const Pseudorange> pseudoranges) {
  constexpr std::size_t kUnknowns = 4;
  if (pseudoranges.size() < kUnknowns) return std::nullopt;
  glm::dvec3 mean(0);
  for (const Pseudorange& each : pseudoranges) mean += each.direction;
  mean /= static_cast<double>(pseudoranges.size());
  glm::dmat3 normal(0);
  glm::dvec3 right(0);
  for (const Pseudorange& each : pseudoranges) {
    const glm::dvec3 from_mean = each.direction - mean;
    normal += glm::outerProduct(from_mean, from_mean);
    right += each.error_m * from_mean;
  }
  const double trace = normal[0][0] + normal[1][1] + normal[2][2];
  if (!(glm::determinant(normal) > kDeterminantError * trace * trace * trace)) return std::nullopt;
  const glm::dmat3 cofactors = glm::inverse(normal);
  const double square_pdop = cofactors[0][0] + cofactors[1][1] + cofactors[2][2];
  if (!(square_pdop > 0 && square_pdop <= kMaxPdop * kMaxPdop)) return std::nullopt;
  return PositionFix{.error_m = -(cofactors * right), .cofactors = cofactors};
}

}  // namespace simvis
