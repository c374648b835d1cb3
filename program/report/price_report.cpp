#include "program/report/price_report.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <simvis/attributes.h>
#include "program/output/item_file.h"
#include "program/output/number_text.h"
#include "program/report/aligned_table.h"

namespace simvis {

namespace {

using Style = NumberFormat::Style;
using Cells = std::vector<std::string>;

constexpr NumberFormat kTime{Style::fixed, 3}, kRatio{Style::fixed, 2}, kPercent{Style::general, 3};
constexpr NumberFormat kLength{Style::scientific, 1}, kExact{Style::general, 9};

/// Text for the table: NaN is a dash, and 0 is not written as 0.0e+00.
std::string shown(const NumberFormat& format, double value) {
  if (std::isnan(value)) return "-";
  return value == 0 && format.style != Style::fixed ? "0" : number_cell(format, value);
}

std::string shown(std::optional<double> value) { return value ? format_number(*value) : "-"; }

/// The tolerances for which this variant is recommended: "0.001 1e-04".
std::string cheapest_of(const ScannerPrice& price, std::size_t variant) {
  std::string text;
  for (const double tolerance : kPriceTolerances_rel) {
    if (cheapest_for(price, tolerance) == variant) text += (text.empty() ? "" : " ") + format_number(tolerance);
  }
  return text;
}

std::string joined(const std::vector<double>& tolerances) {
  std::string text;
  for (std::size_t i = 0; i < tolerances.size(); ++i) {
    text += (i == 0 ? "" : i + 1 == tolerances.size() ? " and " : ", ") + format_number(tolerances[i]);
  }
  return text;
}

/// The variant named if no variant meets a tolerance: the one with the fewest beams without a bound; among equals, the
/// one with the smallest largest bound.
const VariantPrice& surest(const ScannerPrice& price) {
  return *std::ranges::min_element(price.variants, [](const VariantPrice& a, const VariantPrice& b) {
    if (a.unbounded_share != b.unbounded_share) return a.unbounded_share < b.unbounded_share;
    return a.bound_largest_rel < b.bound_largest_rel;
  });
}

}  // namespace

std::string to_table(const ScannerPrice& price) {
  const std::uint32_t per_ring = price.beams / price.rings;
  std::string title = price.scanner + ": " + std::to_string(per_ring) + " beams";
  if (price.rings > 1) title += " x " + std::to_string(price.rings) + " rings";
  title += ", " + std::to_string(price.frames) + (price.frames == 1 ? " frame" : " frames") + " of each\n";
  std::vector<Cells> rows = {
      {"", "", "", "", "", "", "", "median", "bound", "largest", "bound", "no", "error", "", "error of", "wrong", ""},
      {"method", "resolution", "max_error_rel", "max_error_m", "ms", "ratio", "cast %", "m", "rel", "m", "rel",
       "bound %", "m", "rel", "unbounded", "kind %", "cheapest for"}};
  for (std::size_t i = 0; i < price.variants.size(); ++i) {
    const VariantPrice& v = price.variants[i];
    rows.push_back({(v.variant.method.empty() ? kNoMethod : v.variant.method) + (v.in_scene ? " *" : ""),
                    shown(v.variant.resolution_px), shown(v.variant.max_error_rel), shown(v.variant.max_error_m),
                    shown(kTime, v.median_ms), shown(kRatio, v.ratio), shown(kPercent, 100 * v.cast_share),
                    shown(kLength, v.bound_median_m), shown(kLength, v.bound_median_rel),
                    shown(kLength, v.bound_largest_m), shown(kLength, v.bound_largest_rel),
                    shown(kPercent, 100 * v.unbounded_share), shown(kLength, v.difference_largest_m),
                    shown(kLength, v.difference_largest_rel), shown(kLength, v.unbounded_difference_m),
                    shown(kPercent, 100 * v.wrong_kind_share), cheapest_of(price, i)});
  }
  return title + aligned(rows) + price_advice(price) + '\n';
}

std::string price_legend() {
  return "ms: the median frame in which only that scanner measures; ratio: of that to the cheapest; cast: beams for "
         "which a ray was cast.\n"
         "bound: the error bound of a range, where it is finite; it is valid for surfaces at least three pixels "
         "wide.\n"
         "error: difference to the range of raycast. m: metres; rel: share of the range. *: as the scene has it.\n"
         "wrong kind: beams whose kind (hit, miss or too near) differs from that of raycast.\n"
         "cheapest for: the cheapest variant whose bound and error are within that share of the range for every "
         "beam.\n";
}

std::string price_advice(const ScannerPrice& price) {
  std::string text;
  const auto say = [&](const std::string& clause) { text += (text.empty() ? ": " : "; ") + clause; };
  std::vector<double> pending;
  std::optional<std::size_t> chosen;
  const auto say_pending = [&] {
    if (pending.empty()) return;
    if (chosen) {
      const VariantPrice& variant = price.variants[*chosen];
      say("for " + joined(pending) + " write " + attributes_of(variant.variant) + " (" +
          number_cell(kTime, variant.median_ms) + " ms)");
    } else {
      const VariantPrice& best = surest(price);
      say("no variant keeps " + joined(pending) + ", nearest is " + attributes_of(best.variant) +
          " with bounds up to " + shown(kLength, best.bound_largest_rel) + " and none for " +
          shown(kPercent, 100 * best.unbounded_share) + " % of the beams");
    }
    pending.clear();
  };
  for (const double tolerance : kPriceTolerances_rel) {
    const std::optional<std::size_t> variant = cheapest_for(price, tolerance);
    if (variant != chosen) say_pending();
    chosen = variant;
    pending.push_back(tolerance);
  }
  say_pending();
  return price.scanner + text;
}

std::string to_csv(std::span<const ScannerPrice> prices) {
  std::string text =
      "scanner,beams,frames,method,resolution_px,max_error_rel,max_error_m,in_scene,median_ms,ratio,cast_share,bound_"
      "median_m,"
      "bound_median_rel,bound_largest_m,bound_largest_rel,unbounded_share,difference_largest_m,difference_largest_rel,"
      "unbounded_difference_m,wrong_kind_share,cheapest_for\n";
  for (const ScannerPrice& price : prices) {
    for (std::size_t i = 0; i < price.variants.size(); ++i) {
      const VariantPrice& v = price.variants[i];
      text += csv_field(price.scanner) + ',' + std::to_string(price.beams) + ',' + std::to_string(price.frames) + ',' +
              v.variant.method;
      for (const double value :
           {v.variant.resolution_px.value_or(VariantPrice::kNone),
            v.variant.max_error_rel.value_or(VariantPrice::kNone), v.variant.max_error_m.value_or(VariantPrice::kNone),
            v.in_scene ? 1.0 : 0.0, v.median_ms, v.ratio, v.cast_share, v.bound_median_m, v.bound_median_rel,
            v.bound_largest_m, v.bound_largest_rel, v.unbounded_share, v.difference_largest_m, v.difference_largest_rel,
            v.unbounded_difference_m, v.wrong_kind_share}) {
        text += ',' + number_cell(kExact, value);
      }
      text += ',' + cheapest_of(price, i) + '\n';
    }
  }
  return text;
}

}  // namespace simvis
