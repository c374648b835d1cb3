#include "program/report/cost_report.h"

#include <algorithm>
#include <optional>

#include <simvis/attributes.h>
#include "program/output/number_text.h"
#include "program/report/cost_run.h"

namespace simvis {

namespace {

using Style = NumberFormat::Style;

constexpr NumberFormat kTime{Style::fixed, 3}, kRatio{Style::fixed, 2}, kPercent{Style::general, 3};
constexpr NumberFormat kLength{Style::scientific, 1};

/// The tolerances for which this variant is recommended: "0.001 1e-04".
std::string cheapest_of(const ScannerCosts& costs, std::size_t variant) {
  std::string text;
  for (const double tolerance : kCostTolerances_rel) {
    if (cheapest_for(costs, tolerance) == variant) text += (text.empty() ? "" : " ") + format_number(tolerance);
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
const VariantCosts& surest(const ScannerCosts& costs) {
  return *std::ranges::min_element(costs.variants, [](const VariantCosts& a, const VariantCosts& b) {
    if (a.unbounded_share != b.unbounded_share) return a.unbounded_share < b.unbounded_share;
    return a.bound_largest_rel < b.bound_largest_rel;
  });
}

template <double VariantCosts::*kMember>
ReportValue number_of(const CostRow& row) {
  return row.variant.*kMember;
}

template <std::optional<double> ScanVariant::*kMember>
constexpr ReportColumn<CostRow> setting(const char* name, const char* head) {
  return {.name = name,
          .get = [](const CostRow& row) -> ReportValue {
            return (row.variant.variant.*kMember).value_or(VariantCosts::kNone);
          },
          .head1 = "",
          .head2 = head,
          .text =
              [](const CostRow& row) {
                const std::optional<double> value = row.variant.variant.*kMember;
                return value ? format_number(*value) : "-";
              }};
}

std::string method_text(const CostRow& row) {
  const std::string& method = row.variant.variant.method;
  return (method.empty() ? kNoMethod : method) + (row.variant.in_scene ? " *" : "");
}

using P = VariantCosts;

constexpr ReportColumn<CostRow> kCostColumns[] = {
    {"scanner", [](const CostRow& row) -> ReportValue { return row.costs.scanner; }},
    {"beams", [](const CostRow& row) -> ReportValue { return std::uint64_t{row.costs.beams}; }},
    {"frames", [](const CostRow& row) -> ReportValue { return row.costs.frames; }},
    {"load", [](const CostRow& row) -> ReportValue { return row.costs.load; }},
    {.name = "method",
     .get = [](const CostRow& row) -> ReportValue { return row.variant.variant.method; },
     .head1 = "",
     .head2 = "method",
     .text = method_text},
    setting<&ScanVariant::resolution_px>("resolution_px", "resolution"),
    setting<&ScanVariant::max_error_rel>("max_error_rel", "max_error_rel"),
    setting<&ScanVariant::max_error_m>("max_error_m", "max_error_m"),
    {"in_scene", [](const CostRow& row) -> ReportValue { return row.variant.in_scene; }},
    {"median_ms", number_of<&P::median_ms>, "", "ms", kTime},
    {"first_quartile_ms", number_of<&P::first_quartile_ms>, "first", "quartile", kTime},
    {"third_quartile_ms", number_of<&P::third_quartile_ms>, "third", "quartile", kTime},
    {"processor_ms", number_of<&P::processor_ms>, "processor", "ms", kTime},
    {"ratio", number_of<&P::ratio>, "", "ratio", kRatio},
    {"cast_share", number_of<&P::cast_share>, "", "cast %", kPercent, 100},
    {"bound_median_m", number_of<&P::bound_median_m>, "median", "m", kLength},
    {"bound_median_rel", number_of<&P::bound_median_rel>, "bound", "rel", kLength},
    {"bound_largest_m", number_of<&P::bound_largest_m>, "largest", "m", kLength},
    {"bound_largest_rel", number_of<&P::bound_largest_rel>, "bound", "rel", kLength},
    {"unbounded_share", number_of<&P::unbounded_share>, "no", "bound %", kPercent, 100},
    {"difference_largest_m", number_of<&P::difference_largest_m>, "error", "m", kLength},
    {"difference_largest_rel", number_of<&P::difference_largest_rel>, "", "rel", kLength},
    {"unbounded_difference_m", number_of<&P::unbounded_difference_m>, "error of", "unbounded", kLength},
    {"wrong_kind_share", number_of<&P::wrong_kind_share>, "wrong", "kind %", kPercent, 100},
    {"cheapest_for",
     [](const CostRow& row) -> ReportValue {
       return cheapest_of(row.costs, static_cast<std::size_t>(&row.variant - row.costs.variants.data()));
     },
     "", "cheapest for"}};

}  // namespace

std::span<const ReportColumn<CostRow>> cost_columns() { return kCostColumns; }

std::vector<CostRow> cost_rows(std::span<const ScannerCosts> all_costs) {
  std::vector<CostRow> rows;
  for (const ScannerCosts& costs : all_costs) {
    for (const VariantCosts& variant : costs.variants) rows.push_back({costs, variant});
  }
  return rows;
}

std::string to_table(const ScannerCosts& costs) {
  const std::uint32_t per_ring = costs.beams / costs.rings;
  std::string title = costs.scanner + ": " + std::to_string(per_ring) + " beams";
  if (costs.rings > 1) title += " x " + std::to_string(costs.rings) + " rings";
  return cost_title(title, costs.frames, costs.load) + report_text<CostRow>(kCostColumns, cost_rows({&costs, 1})) +
         cost_advice(costs) + '\n';
}

std::string cost_legend() {
  return "ms: the median frame in which only that scanner measures, with the quartiles of the frames; processor ms: of "
         "all threads; ratio: of ms to the cheapest; cast: beams for which a ray was cast.\n"
         "bound: the error bound of a range, where it is finite; it is valid for surfaces at least three pixels "
         "wide.\n"
         "error: difference to the range of raycast. m: metres; rel: share of the range. *: as the scene has it.\n"
         "wrong kind: beams whose kind (hit, miss or too near) differs from that of raycast.\n"
         "cheapest for: the cheapest variant whose bound and error are within that share of the range for every "
         "beam.\n";
}

std::string cost_advice(const ScannerCosts& costs) {
  std::string text;
  const auto say = [&](const std::string& clause) { text += (text.empty() ? ": " : "; ") + clause; };
  std::vector<double> pending;
  std::optional<std::size_t> chosen;
  const auto say_pending = [&] {
    if (pending.empty()) return;
    if (chosen) {
      const VariantCosts& variant = costs.variants[*chosen];
      say("for " + joined(pending) + " write " + attributes_of(variant.variant) + " (" +
          number_cell(kTime, variant.median_ms) + " ms)");
    } else {
      const VariantCosts& best = surest(costs);
      say("no variant keeps " + joined(pending) + ", nearest is " + attributes_of(best.variant) +
          " with bounds up to " + report_number(kLength, best.bound_largest_rel) + " and none for " +
          report_number(kPercent, 100 * best.unbounded_share) + " % of the beams");
    }
    pending.clear();
  };
  for (const double tolerance : kCostTolerances_rel) {
    const std::optional<std::size_t> variant = cheapest_for(costs, tolerance);
    if (variant != chosen) say_pending();
    chosen = variant;
    pending.push_back(tolerance);
  }
  say_pending();
  return costs.scanner + text;
}

std::string to_csv(std::span<const ScannerCosts> all_costs) {
  return report_csv<CostRow>(kCostColumns, cost_rows(all_costs));
}

}  // namespace simvis
