#include <algorithm>
#include <cctype>
#include <vector>

#include <simvis/location.h>

namespace simvis {
namespace {

constexpr std::size_t kLongestName = 200;  // longer names are not typing errors, and they cost time

std::string lower(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

// Damerau-Levenshtein distance (optimal string alignment): insertions, deletions, substitutions and swaps of adjacent
// characters.
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1])});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    std::swap(before, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

}  // namespace

std::string nearest_name(std::string_view seen, std::span<const std::string_view> known) {
  // A part's names have its own name in front if there are several copies of the part.
  const std::string of_copy = "/" + std::string(seen);
  const auto copy = std::ranges::find_if(known, [&](std::string_view name) { return name.ends_with(of_copy); });
  if (!seen.empty() && copy != known.end()) return std::string(*copy);
  const std::string seen_lower = lower(seen.substr(0, kLongestName));
  std::string_view best;
  std::size_t best_distance = 0;
  for (const std::string_view name : known) {
    // A third of the letters may be wrong. In a name of one or two letters only their case may be wrong.
    const std::size_t longer = std::max(seen.size(), name.size());
    const std::size_t difference = longer - std::min(seen.size(), name.size());
    if (longer > kLongestName || difference > longer / 3) continue;
    const std::size_t d = distance(seen_lower, lower(name));
    if (d > longer / 3) continue;
    if (best.empty() || d < best_distance) {
      best = name;
      best_distance = d;
    }
  }
  return std::string(best);
}

std::string suggestion(std::string_view seen, std::span<const std::string_view> known) {
  const std::string name = nearest_name(seen, known);
  return name.empty() ? name : ", did you mean " + in_quotes(name) + "?";
}

}  // namespace simvis
