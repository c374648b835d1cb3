#include "scenegraph/wall_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <simvis/attributes.h>

namespace simvis {
namespace {

constexpr double kMinPiece_m = 1e-6;
// A sharper corner would be longer than 11 times the wall's thickness: 1 / tan(10 degrees / 2).
constexpr double kMinCorner_deg = 10;

struct Piece {
  glm::dvec2 from, to;
  glm::dvec2 direction, left;  // unit vectors
  double length_m, start_m;    // start_m along the polyline
  // Of the side to the left at both ends, as vectors for a thickness of 2; the right side has the opposite.
  glm::dvec2 from_side, to_side;
};

glm::dvec2 left_of(const glm::dvec2& direction) { return {-direction.y, direction.x}; }

// Where the left sides of two pieces of unit half thickness meet, from the corner.
glm::dvec2 mitre(const Piece& before, const Piece& after) {
  return (before.left + after.left) / (1 + glm::dot(before.left, after.left));
}

double corner_deg(const Piece& before, const Piece& after) {
  const double turn = std::atan2(before.direction.x * after.direction.y - before.direction.y * after.direction.x,
                                 glm::dot(before.direction, after.direction));
  return 180 - glm::degrees(std::abs(turn));
}

bool is_closed(const WallPlan& plan) { return plan.points.size() > 3 && plan.points.front() == plan.points.back(); }

std::vector<Piece> pieces_of(const WallPlan& plan) {
  std::vector<Piece> pieces;
  double start_m = 0;
  for (std::size_t i = 0; i + 1 < plan.points.size(); ++i) {
    const glm::dvec2 way = plan.points[i + 1] - plan.points[i];
    const double length_m = glm::length(way);
    const glm::dvec2 direction = way / std::max(length_m, kMinPiece_m), left = left_of(direction);
    pieces.push_back({plan.points[i], plan.points[i + 1], direction, left, length_m, start_m, left, left});
    start_m += length_m;
  }
  const auto join = [](Piece& before, Piece& after) { before.to_side = after.from_side = mitre(before, after); };
  for (std::size_t i = 0; i + 1 < pieces.size(); ++i) join(pieces[i], pieces[i + 1]);
  if (is_closed(plan)) join(pieces.back(), pieces.front());
  return pieces;
}

// How far the corners at both ends of a piece reach into it.
std::pair<double, double> reach_of_corners(const Piece& piece, double thickness_m) {
  const double half = thickness_m / 2;
  return {half * std::abs(glm::dot(piece.from_side, piece.direction)),
          half * std::abs(glm::dot(piece.to_side, piece.direction))};
}

// Appends quads with flat normals.
class WallSides {
 public:
  explicit WallSides(const WallPlan& plan) : plan_(plan) { mesh_.name = "wall"; }

  Mesh run() {
    const std::vector<Piece> pieces = pieces_of(plan_);
    for (const Piece& piece : pieces) add(piece);
    if (!is_closed(plan_)) {
      const Piece &first = pieces.front(), &last = pieces.back();
      add_end(first, begin_of(first), -first.direction);
      add_end(last, end_of(last), last.direction);
    }
    compute_bounds(mesh_);
    return std::move(mesh_);
  }

 private:
  // A line across the wall: its ends on both sides.
  struct Cut {
    glm::dvec2 left, right;
  };
  // A stretch of a piece between two cuts, with the opening that it has.
  struct Stretch {
    Cut from, to;
    const WallOpening* opening;
  };
  using Corner = glm::dvec3;

  Cut cut(const glm::dvec2& middle, const glm::dvec2& side) const {
    const glm::dvec2 offset = plan_.thickness_m / 2 * side;
    return {middle + offset, middle - offset};
  }
  Cut begin_of(const Piece& piece) const { return cut(piece.from, piece.from_side); }
  Cut end_of(const Piece& piece) const { return cut(piece.to, piece.to_side); }
  Cut across(const Piece& piece, double at_m) const { return cut(piece.from + at_m * piece.direction, piece.left); }

  std::vector<Stretch> stretches(const Piece& piece) const {
    std::vector<const WallOpening*> openings;
    for (const WallOpening& each : plan_.openings) {
      if (each.at_m > piece.start_m && each.at_m < piece.start_m + piece.length_m) openings.push_back(&each);
    }
    std::ranges::sort(openings, {}, &WallOpening::at_m);
    std::vector<Stretch> all;
    Cut from = begin_of(piece);
    for (const WallOpening* const opening : openings) {
      const double middle_m = opening->at_m - piece.start_m, half_m = opening->width_m / 2;
      const Cut begin = across(piece, middle_m - half_m), end = across(piece, middle_m + half_m);
      all.push_back({from, begin, nullptr});
      all.push_back({begin, end, opening});
      from = end;
    }
    all.push_back({from, end_of(piece), nullptr});
    return all;
  }

  void add(const Piece& piece) {
    for (const Stretch& each : stretches(piece)) {
      const WallOpening* const opening = each.opening;
      if (opening == nullptr) {
        add_solid(piece, each, 0, plan_.height_m);
        continue;
      }
      const double top_m = opening->sill_m + opening->height_m;
      if (opening->sill_m > 0) add_solid(piece, each, 0, opening->sill_m);
      if (top_m < plan_.height_m) add_solid(piece, each, top_m, plan_.height_m);
      add_end(piece, each.from, piece.direction, opening->sill_m, top_m);
      add_end(piece, each.to, -piece.direction, opening->sill_m, top_m);
    }
  }

  void add_solid(const Piece& piece, const Stretch& s, double low_m, double high_m) {
    const glm::dvec3 left(piece.left, 0);
    const auto at = [](const glm::dvec2& p, double z) { return Corner(p, z); };
    add_quad({at(s.to.left, low_m), at(s.from.left, low_m), at(s.from.left, high_m), at(s.to.left, high_m)}, left,
             piece);
    add_quad({at(s.from.right, low_m), at(s.to.right, low_m), at(s.to.right, high_m), at(s.from.right, high_m)}, -left,
             piece);
    add_quad({at(s.from.right, high_m), at(s.to.right, high_m), at(s.to.left, high_m), at(s.from.left, high_m)},
             {0, 0, 1}, piece);
    add_quad({at(s.from.left, low_m), at(s.to.left, low_m), at(s.to.right, low_m), at(s.from.right, low_m)}, {0, 0, -1},
             piece);
  }

  // The side that closes the wall at a cut and faces along `normal`.
  void add_end(const Piece& piece, const Cut& at, const glm::dvec2& normal) {
    add_end(piece, at, normal, 0, plan_.height_m);
  }
  void add_end(const Piece& piece, const Cut& at, const glm::dvec2& normal, double low_m, double high_m) {
    glm::dvec2 first = at.right, second = at.left;
    if (glm::dot(normal, piece.direction) < 0) std::swap(first, second);
    add_quad({Corner(first, low_m), Corner(second, low_m), Corner(second, high_m), Corner(first, high_m)},
             glm::dvec3(normal, 0), piece);
  }

  // The corners stand counter-clockwise, seen from where the normal points.
  void add_quad(const std::array<Corner, 4>& corners, const glm::dvec3& normal, const Piece& piece) {
    const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
    const bool level = normal.z != 0;
    for (const Corner& corner : corners) {
      const glm::dvec2 from_start = glm::dvec2(corner) - piece.from;
      const double along_m = piece.start_m + glm::dot(from_start, piece.direction);
      const double across_m = glm::dot(from_start, piece.left);
      const bool across = !level && std::abs(glm::dot(glm::dvec2(normal), piece.direction)) > 0.5;
      VertexAttributes attributes;
      attributes.normal = glm::vec3(normal);
      attributes.uv[0] = attributes.uv[1] =
          glm::vec2((across ? across_m : along_m) / plan_.height_m, 1 - (level ? across_m : corner.z) / plan_.height_m);
      mesh_.positions.emplace_back(corner);
      mesh_.attributes.push_back(attributes);
    }
    mesh_.indices.insert(mesh_.indices.end(), {first, first + 1, first + 2, first, first + 2, first + 3});
  }

  const WallPlan& plan_;
  Mesh mesh_;
};

std::optional<WallError> check_pieces(const WallPlan& plan, const std::vector<Piece>& pieces) {
  const auto wrong = [](std::string what) { return WallError{WallError::Of::points, 0, std::move(what)}; };
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (pieces[i].length_m < kMinPiece_m) return wrong("point " + std::to_string(i + 2) + " is the one before it");
    const bool is_last = i + 1 == pieces.size();
    if (is_last && !is_closed(plan)) break;
    const double corner = corner_deg(pieces[i], pieces[is_last ? 0 : i + 1]);
    if (corner >= kMinCorner_deg) continue;
    return wrong("the corner at point " + std::to_string(is_last ? 1 : i + 2) + " has " + format_number(corner) +
                 " degrees, expected at least " + format_number(kMinCorner_deg));
  }
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const auto [from_m, to_m] = reach_of_corners(pieces[i], plan.thickness_m);
    if (from_m + to_m < pieces[i].length_m) continue;
    return wrong("points " + std::to_string(i + 1) + " and " + std::to_string(i + 2) +
                 " are too near to each other for a wall of this thickness");
  }
  return std::nullopt;
}

std::optional<std::string> check_opening(const WallPlan& plan, const WallOpening& opening,
                                         const std::vector<Piece>& pieces) {
  if (opening.sill_m + opening.height_m > plan.height_m) {
    return "its upper edge is at " + format_number(opening.sill_m + opening.height_m) + " m, and the wall is " +
           format_number(plan.height_m) + " m high";
  }
  const double begin_m = opening.at_m - opening.width_m / 2, end_m = opening.at_m + opening.width_m / 2;
  for (const Piece& piece : pieces) {
    const auto [from_m, to_m] = reach_of_corners(piece, plan.thickness_m);
    if (begin_m > piece.start_m + from_m && end_m < piece.start_m + piece.length_m - to_m) return std::nullopt;
  }
  return "it is not within one straight piece of the wall, clear of its corners: it reaches from " +
         format_number(begin_m) + " to " + format_number(end_m) + " m along the points, and the wall has " +
         format_number(pieces.back().start_m + pieces.back().length_m) + " m";
}

}  // namespace

std::optional<WallError> check_wall(const WallPlan& plan) {
  const std::vector<Piece> pieces = pieces_of(plan);
  if (auto error = check_pieces(plan, pieces)) return error;
  for (std::size_t i = 0; i < plan.openings.size(); ++i) {
    const WallOpening& opening = plan.openings[i];
    if (auto what = check_opening(plan, opening, pieces)) return WallError{WallError::Of::openings, i, *what};
    for (std::size_t j = 0; j < i; ++j) {
      const WallOpening& other = plan.openings[j];
      if (std::abs(opening.at_m - other.at_m) > (opening.width_m + other.width_m) / 2) continue;
      return WallError{WallError::Of::openings, i,
                       "it overlaps or touches the one at " + format_number(other.at_m) + " m"};
    }
  }
  return std::nullopt;
}

Mesh wall_mesh(const WallPlan& plan) { return WallSides(plan).run(); }

}  // namespace simvis
